#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace atrium::simulated_cameras {

/// A camera that is away for a while: it answers nothing, and comes back as one that was just
/// switched on.
struct Outage {
    std::size_t camera = 0;
    double from_s = 0.0;  // after the first picture
    double seconds = 0.0;
};

/// What goes wrong, per camera of the rig.
struct Faults {
    std::vector<double> lost_share;       // of its packets, 0 to 1
    std::vector<double> delay_ms;         // of its pictures, after their trigger
    std::vector<double> clock_offset_ms;  // of its time stamps
    std::vector<Outage> outages;          // by time
};

/// The faults as the command line has them; a camera is given by its name or its number.
///   lose, delay_ms, clock_offset_ms: "CAMERA=VALUE,CAMERA=VALUE", lose in percent
///   stop: "CAMERA@FROM+SECONDS,..."; restart: "CAMERA@FROM,..."
struct FaultTexts {
    std::string lose{};
    std::string delay_ms{};
    std::string clock_offset_ms{};
    std::string stop{};
    std::string restart{};
};

/// Error kConfiguration that names the option and what is wrong with it.
Expected<Faults> parse_faults(const FaultTexts& texts, const config::Rig& rig);

}  // namespace atrium::simulated_cameras
