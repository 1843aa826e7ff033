#pragma once

#include "core/geometry/pinhole_camera.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// What the user has measured: indices of cameras.
struct Measured {
    std::vector<std::size_t> heights;
    std::optional<std::array<std::size_t, 2>> distance;
};

/// Names what a tape can verify of a rig, in metres with +Z up: a distance of two cameras, and
/// their heights if `has_floor`. Chooses cameras that were not measured, far from those that were.
/// Empty if everything was measured.
std::string tape_check(std::span<const geometry::CalibratedCamera> cameras,
                       const Measured& measured,
                       bool has_floor);

}  // namespace atrium::calibrate
