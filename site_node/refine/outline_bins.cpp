#include "site_node/refine/outline_bins.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace atrium::refine {

std::optional<std::uint64_t> outline_bin(const geometry::CalibratedCamera& camera,
                                         std::size_t index,
                                         const Eigen::Vector3d& point_site,
                                         double bin_px) {
    constexpr double kMostBins = 1 << 20;
    const Eigen::Vector3d at =
        camera.camera_from_site.rotation * point_site + camera.camera_from_site.translation;
    if (!(at.z() > kNearest_m)) return std::nullopt;
    const Eigen::Vector2d place = camera.intrinsics.project(at) / bin_px;
    if (!(place.cwiseAbs().maxCoeff() < kMostBins)) return std::nullopt;
    const auto along = [&](double bin) {
        return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(bin)) + (1 << 21));
    };
    return (static_cast<std::uint64_t>(index) << 44U) | (along(place.x()) << 22U) |
           along(place.y());
}

void keep_least(std::vector<OutlinePoint>& points) {
    std::ranges::sort(points, [](const OutlinePoint& a, const OutlinePoint& b) {
        if (a.bin != b.bin) return a.bin < b.bin;
        return a.cost != b.cost ? a.cost < b.cost : a.index < b.index;
    });
    const auto left = std::ranges::unique(points, {}, &OutlinePoint::bin);
    points.erase(left.begin(), left.end());
}

void find_on_outlines(const Surfels& surfels,
                      std::span<const PictureView> views,
                      std::span<const double> bins_px,
                      std::vector<OutlinePoint>& points) {
    points.clear();
    for (std::size_t i = 0; i < surfels.size(); ++i) {
        if (surfels[i].owner == hull::kNoOwner) continue;
        const auto view = static_cast<std::size_t>(surfels[i].owner);
        const auto bin = outline_bin(
            *views[view].camera, view, surfels[i].position_site.cast<double>(), bins_px[view]);
        if (bin) points.push_back({*bin, 0.0F, static_cast<std::uint32_t>(i)});
    }
    std::ranges::sort(
        points, {}, [](const OutlinePoint& point) { return std::pair(point.bin, point.index); });
}

}  // namespace atrium::refine
