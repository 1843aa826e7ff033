#pragma once

#include <array>
#include <string_view>

/// Embeds the files of qos/ in the library, as they were at build time.
namespace atrium::bus {

struct BuiltinNetwork {
    std::string_view kind;  // the file is qos/<kind>.xml
    std::string_view xml;
};

extern const std::string_view kBuiltinProfiles;  // qos/profiles.xml
extern const std::array<BuiltinNetwork, 5> kBuiltinNetworks;

}  // namespace atrium::bus
