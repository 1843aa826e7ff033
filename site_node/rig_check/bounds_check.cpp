#include "site_node/rig_check/bounds_check.hpp"

#include "site_node/rig_check/agreeing_depths.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace atrium::rig_check {
namespace {

constexpr double kTooLarge = 15.0;  // times the distance between the cameras
constexpr double kTooSmall = 0.02;
constexpr int kPointsPerSide = 9;  // of a grid in a region

struct LengthUnit {
    const char* plural;
    double metres;
    double rarity;  // in units of the logarithm of a size
};
constexpr std::array<LengthUnit, 5> kLengthUnits{{{"metres", 1.0, 0.0},
                                                  {"millimetres", 0.001, 0.0},
                                                  {"centimetres", 0.01, 0.3},
                                                  {"inches", 0.0254, 1.2},
                                                  {"feet", 0.3048, 1.2}}};

}  // namespace

std::optional<Finding> check_bounds(const geometry::Aabb& bounds_site,
                                    std::span<const geometry::CalibratedCamera> cameras,
                                    double unit_m) {
    double widest_m = 0.0;
    for (const auto& a : cameras)
        for (const auto& b : cameras)
            widest_m = std::max(widest_m, (a.centre_site() - b.centre_site()).norm());
    const double size_m = bounds_site.size().maxCoeff();
    if (!(widest_m > 0.0) || (size_m < kTooLarge * widest_m && size_m > kTooSmall * widest_m))
        return std::nullopt;
    // the unit in which the same numbers fit the cameras best; some are rarer than others
    const auto misfit = [&](const LengthUnit& unit) {
        return unit.rarity + std::abs(std::log(size_m / unit_m * unit.metres / widest_m));
    };
    const LengthUnit& likely = *std::ranges::min_element(kLengthUnits, {}, misfit);
    const auto own = std::ranges::find_if(kLengthUnits, [&](const LengthUnit& unit) {
        return std::abs(unit.metres / unit_m - 1.0) < 1e-6;
    });
    return Finding{
        false,
        fmt::format("[bounds] are {:.4g} m large, and the cameras at most {:.3g} m apart: they "
                    "look like {} ({:.3g} m then); write them in {}, the unit of the rig",
                    size_m,
                    widest_m,
                    likely.plural,
                    size_m / unit_m * likely.metres,
                    own == kLengthUnits.end() ? "its units" : own->plural)};
}

std::optional<Finding> check_region(const geometry::Aabb& bounds_site,
                                    std::span<const geometry::CalibratedCamera> cameras,
                                    const std::optional<geometry::Aabb>& room_site) {
    if (room_site && ((bounds_site.max.array() <= room_site->min.array()).any() ||
                      (bounds_site.min.array() >= room_site->max.array()).any()))
        return Finding{false,
                       "its bounds lie outside of [bounds] of the rig: nobody is expected there; "
                       "they are in metres, in the frame of the site"};
    geometry::Aabb reach;  // beyond the cameras
    for (const auto& camera : cameras) reach.add(camera.centre_site());
    const double margin_m = 0.5 * reach.size().norm();
    reach.min.array() -= margin_m;
    reach.max.array() += margin_m;
    std::vector<hull::SilhouetteView> views(cameras.size());
    std::vector<Projector> projectors;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        views[i].intrinsics = cameras[i].intrinsics;
        views[i].camera_from_site = cameras[i].camera_from_site;
        projectors.emplace_back(views[i], true);
    }
    for (int i = 0; i < kPointsPerSide * kPointsPerSide * kPointsPerSide; ++i) {
        const Eigen::Array3d cell(i % kPointsPerSide,
                                  i / kPointsPerSide % kPointsPerSide,
                                  i / kPointsPerSide / kPointsPerSide);
        const Eigen::Vector3d point =
            bounds_site.min.array() + bounds_site.size().array() * (cell + 0.5) / kPointsPerSide;
        if (!reach.contains(point)) continue;
        const auto num_seeing = std::ranges::count_if(
            projectors, [&](const Projector& camera) { return camera.is_in_picture(point); });
        if (num_seeing >= 2) return std::nullopt;
    }
    return Finding{false,
                   "its bounds lie outside the room, where no two cameras of the rig look: nobody "
                   "can be found there; "
                   "they are in metres, in the frame of the site"};
}

}  // namespace atrium::rig_check
