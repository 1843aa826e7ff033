#include "site_node/silhouette/picture_field.hpp"

#include "site_node/silhouette/undistort_polygon.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace atrium::silhouette {

double field_inset_px(double tolerance_px) { return std::max(2.0, tolerance_px + 1.0); }

std::optional<std::vector<Eigen::Vector2d>> picture_field(const geometry::PinholeCamera& intrinsics,
                                                          double inset_px) {
    const double left = inset_px - 0.5;
    const double top = inset_px - 0.5;
    const double right = (intrinsics.width & ~1) - 0.5 - inset_px;
    const double bottom = (intrinsics.height & ~1) - 0.5 - inset_px;
    if (right <= left || bottom <= top) return std::nullopt;
    // +Y of the picture is down, but counter-clockwise is defined with +Y up
    const std::array<Eigen::Vector2d, 4> corners{Eigen::Vector2d(left, top),
                                                 Eigen::Vector2d(right, top),
                                                 Eigen::Vector2d(right, bottom),
                                                 Eigen::Vector2d(left, bottom)};
    std::vector<Eigen::Vector2d> field;
    std::vector<std::uint32_t> edges;
    if (!undistort_polygon(corners, intrinsics, field, edges)) return std::nullopt;
    return field;
}

}  // namespace atrium::silhouette
