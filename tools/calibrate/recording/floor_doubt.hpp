#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "site_node/rig_check/floor_check.hpp"
#include "tools/calibrate/recording/gather.hpp"

#include <string>
#include <vector>

namespace atrium::calibrate {

/// Says that people stand in the floor or above it, with cause and cure
/// (site_node/rig_check/floor_check.hpp), from the hulls of masks: 12 instants of up to 8 cameras.
/// Empty if the floor is right, without masks, and if masks are few or cannot be read.
/// `measured`: by the user, which may be wrong, with the first camera whose height was measured, or
/// none.
std::string doubt_of_floor(const Material& material,
                           const std::vector<geometry::CalibratedCamera>& cameras,
                           const rig_check::Measured& measured = {},
                           const std::string& measured_camera = {});

}  // namespace atrium::calibrate
