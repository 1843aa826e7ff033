#pragma once

#include "core/geometry/pinhole_camera.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace atrium::refine {

/// A small part of an outline: the square of `bin_px` that shows `point_site` in the camera with
/// this index. Nullopt behind the camera, and where no picture can be.
std::optional<std::uint64_t> outline_bin(const geometry::CalibratedCamera& camera,
                                         std::size_t index,
                                         const Eigen::Vector3d& point_site,
                                         double bin_px);

/// A point of the surface that an outline shows.
struct OutlinePoint {
    std::uint64_t bin = 0;
    float cost = 0.0F;
    std::uint32_t index = 0;  // of a surfel or vertex
};

/// Keeps the point with the least cost in each bin; of equal ones that with the lowest index.
void keep_least(std::vector<OutlinePoint>& points);

}  // namespace atrium::refine
