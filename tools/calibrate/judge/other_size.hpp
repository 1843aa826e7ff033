#pragma once

#include "core/geometry/pinhole_camera.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace atrium::calibrate {

/// Lenses that were calibrated for pictures of another size than theirs.
struct OtherSize {
    double factor = 1.0;                     // of the calibrated size to that of the pictures
    std::optional<std::array<int, 2>> size;  // [px] calibrated; none: the pictures' sizes differ
    std::vector<bool> agrees;                // by camera
    std::size_t num_agreeing = 0;
};

/// Finds the size for which all or nearly all lenses were calibrated, if it is clearly another one
/// than that of their pictures, in the same shape: their principal points lie about in the middle
/// of pictures of that size. Empty for fewer than two cameras. Pure.
std::optional<OtherSize> find_other_size(std::span<const geometry::CalibratedCamera> cameras);

}  // namespace atrium::calibrate
