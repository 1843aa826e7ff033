#pragma once

#include "core/geometry/pinhole_camera.hpp"

#include <string>
#include <vector>

namespace atrium::calibrate {

/// Turns the site frame about its +Z, so that +X points from the origin towards this camera. False
/// if no camera has this name.
bool turn_front_towards(const std::string& name, std::vector<geometry::CalibratedCamera>& cameras);

/// The camera nearest to the direction of +X, as seen from the origin. `cameras`: at least one.
std::string front_camera(const std::vector<geometry::CalibratedCamera>& cameras);

/// "front: people who look towards 'door' look along +X, into the world".
std::string front_text(const std::string& name);

}  // namespace atrium::calibrate
