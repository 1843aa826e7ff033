#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "site_node/refine/luma_picture.hpp"
#include "site_node/refine/surfels.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
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

/// Sets `points` to the surfels that lie on outlines, bin by bin and in rising order, with costs of
/// 0. `views` are those of the hull; squares are as large as `bins_px` says for each.
void find_on_outlines(const Surfels& surfels,
                      std::span<const PictureView> views,
                      std::span<const double> bins_px,
                      std::vector<OutlinePoint>& points);

}  // namespace atrium::refine
