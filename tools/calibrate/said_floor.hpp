#pragma once

#include "tools/calibrate/conclude.hpp"
#include "tools/calibrate/recording/gather.hpp"

#include <string>
#include <vector>

namespace atrium::calibrate {

/// Doubts the floor of a recording with masks (recording/floor_doubt.hpp), and names what the user
/// measured, which may be wrong. Empty without a doubt.
std::string doubt_floor(const Material& material,
                        const std::vector<geometry::CalibratedCamera>& cameras,
                        const Said& said);

}  // namespace atrium::calibrate
