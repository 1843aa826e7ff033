#pragma once

#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"

#include <stop_token>
#include <string>

namespace atrium::record_tool {

struct RoomOrderConfig {
    bus::BusOptions bus;
    std::string site;
    std::string folder;    // name of the new folder in the site's folder of recordings
    double seconds = 0.0;  // 0: until the stop
};

/// Has a running site record its cameras, until the stop or the time is over. kUnavailable if the
/// site does not answer; kConfiguration with its reason if it refuses; kInternal if the recording
/// ended by a fault.
Expected<void> record_room(const RoomOrderConfig& config, std::stop_token stop);

/// Ends the recording of the site's cameras, whoever began it. Errors as above.
Expected<void> stop_room(const RoomOrderConfig& config, std::stop_token stop);

}  // namespace atrium::record_tool
