#pragma once

#include <string_view>

/// The files of qos/ that the library carries, as they were when it was built.
namespace atrium::bus {

extern const std::string_view kBuiltinProfiles;  // qos/profiles.xml
extern const std::string_view kBuiltinNetwork;   // qos/loopback.xml

}  // namespace atrium::bus
