#include "world_server/placement.hpp"

#include <array>
#include <numbers>

namespace atrium::world_server {
namespace {

constexpr double kRingStepM = 1.8;
constexpr std::array<double, 8> kAnglesDeg{90, 270, 45, 135, 225, 315, 0, 180};

geometry::RigidTransform place_on_ring(std::size_t index) {
    const double radius_m = kRingStepM * static_cast<double>(1 + index / kAnglesDeg.size());
    const double angle = kAnglesDeg[index % kAnglesDeg.size()] * std::numbers::pi / 180.0;
    const Eigen::Quaterniond facing_in(
        Eigen::AngleAxisd(angle + std::numbers::pi, Eigen::Vector3d::UnitZ()));
    return {facing_in, {radius_m * std::cos(angle), radius_m * std::sin(angle), 0.0}};
}

}  // namespace

SitePlacer::SitePlacer(const std::vector<NamedPlacement>& named, std::size_t max_sites)
    : max_sites_(max_sites) {
    for (const NamedPlacement& placement : named) {
        world_from_site_[placement.site] = placement.world_from_site;
    }
}

std::optional<geometry::RigidTransform> SitePlacer::place(const std::string& site) {
    const auto found = world_from_site_.find(site);
    if (found != world_from_site_.end()) return found->second;
    if (world_from_site_.size() >= max_sites_) return std::nullopt;
    return world_from_site_[site] = place_on_ring(num_on_ring_++);
}

}  // namespace atrium::world_server
