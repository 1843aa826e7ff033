#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace atrium::simulated_cameras {

/// A period in which a camera answers nothing. It comes back freshly switched on.
struct Outage {
    std::size_t camera = 0;
    double from_s = 0.0;  // after the first picture
    double seconds = 0.0;
};

/// Faults per camera of the rig.
struct Faults {
    std::vector<double> lost_share;       // of its packets, 0 to 1
    std::vector<double> delay_ms;         // of its pictures, after their trigger
    std::vector<double> clock_offset_ms;  // of its time stamps
    std::vector<Outage> outages;          // sorted by time
};

/// Faults as text from the command line. CAMERA is a name or a number.
///   lose, delay_ms, clock_offset_ms: "CAMERA=VALUE,CAMERA=VALUE", lose in percent
///   stop: "CAMERA@FROM+SECONDS,..."; restart: "CAMERA@FROM,..."
struct FaultTexts {
    std::string lose{};
    std::string delay_ms{};
    std::string clock_offset_ms{};
    std::string stop{};
    std::string restart{};
};

/// Parses the faults. Error kConfiguration names the option and the problem.
Expected<Faults> parse_faults(const FaultTexts& texts, const config::Rig& rig);

}  // namespace atrium::simulated_cameras
