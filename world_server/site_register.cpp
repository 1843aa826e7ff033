#include "world_server/site_register.hpp"

#include "core/codec/mesh_codec.hpp"

#include <fmt/format.h>

#include <cassert>
#include <chrono>

namespace atrium::world_server {
namespace {

// Ten times a person as the sites make them; a room is smaller than 15 m around its origin.
constexpr codec::MeshLimits kLimits{
    .max_triangles = 100'000, .max_vertices = 60'000, .max_coordinate_m = 15.0};
// A capture time that lies back by more than this is a site that was started again with another
// clock, such as a recording that is played once more; by less, a sample out of order.
constexpr std::chrono::seconds kRestart{1};

}  // namespace

SiteRegister::SiteRegister(const std::vector<NamedPlacement>& named,
                           std::size_t max_sites,
                           const physics::PersonShapeOptions& options)
    : placer_(named, max_sites), options_(options) {}

Expected<std::optional<bus::SitePlacement>> SiteRegister::arrive(const std::string& site) {
    if (sites_.contains(site)) return std::nullopt;
    const auto place = placer_.place(site);
    if (!place) {
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("site {}: the world has its largest number of sites", site));
    }
    sites_.emplace(site, Site{*place, physics::PersonShaper(options_), {}});
    return bus::SitePlacement{site, *place};
}

Expected<std::optional<physics::PersonShape>> SiteRegister::read_mesh(
    const bus::SiteMesh& message) {
    const auto found = sites_.find(message.site);
    assert(found != sites_.end());
    Site& site = found->second;
    const bool is_late = message.capture_time <= site.last_capture &&
                         site.last_capture - message.capture_time < kRestart;
    if (is_late) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("site {}: mesh {} was captured before the last one",
                                      message.site,
                                      message.frame_id));
    }
    if (message.draco.empty()) {
        site.last_capture = message.capture_time;
        site.shaper.forget();
        return std::nullopt;
    }
    auto mesh = codec::decode_mesh(message.draco, kLimits);
    if (!mesh) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("site {}: {}", message.site, mesh.error().message));
    }
    site.last_capture = message.capture_time;
    for (Eigen::Vector3d& vertex : mesh->vertices) vertex = site.world_from_site * vertex;
    return site.shaper.shape(*mesh, message.capture_time);
}

void SiteRegister::lose_mesh(const std::string& site) {
    const auto found = sites_.find(site);
    if (found == sites_.end()) return;
    found->second.shaper.forget();
    found->second.last_capture = {};
}

bool SiteRegister::leave(const std::string& site) { return sites_.erase(site) > 0; }

}  // namespace atrium::world_server
