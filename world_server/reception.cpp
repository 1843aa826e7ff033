#include "world_server/reception.hpp"

#include "core/app/log.hpp"
#include "core/bus/delays_from.hpp"
#include "world_server/site_reader.hpp"

#include <memory>
#include <utility>

namespace atrium::world_server {

Reception::Reception(const WorldServerConfig& config,
                     PersonPreparation& preparation,
                     Place place,
                     Reject reject)
    : person_(config.person),
      preparation_(preparation),
      place_(std::move(place)),
      reject_(std::move(reject)),
      sites_(config.placements, static_cast<std::size_t>(config.max_sites)) {}

bool Reception::arrive(const std::string& site) {
    const auto placement = sites_.arrive(site);
    if (!placement) {
        reject_(placement.error().message);
        return false;
    }
    if (*placement) {
        const Eigen::Vector3d& position = (*placement)->world_from_site.translation;
        app::log::info("site_arrived site={} position_m={:.2f},{:.2f},{:.2f}",
                       site,
                       position.x(),
                       position.y(),
                       position.z());
        if (const std::string meant = sites_.ask_meant(site); !meant.empty()) {
            app::log::warn(
                "site_not_named site={} reason=\"the world file has no [[site]] of this "
                "name, so it stands on the ring around the origin; {}\"",
                site,
                meant);
        }
        place_(**placement);
        const auto& world_from_site = (*placement)->world_from_site;
        preparation_.arrive(site, [this, world_from_site] {
            const auto reader = std::make_shared<SiteReader>(world_from_site, person_);
            return [reader](const bus::SiteMesh& message) { return reader->read(message); };
        });
    }
    num_present_ = sites_.num_present();
    return true;
}

void Reception::leave(const std::string& site) {
    if (!sites_.leave(site)) return;  // description and meshes end separately
    preparation_.leave(site);
    num_present_ = sites_.num_present();
    app::log::info("site_left site={}", site);
}

void Reception::put(const bus::SiteDescription& description) {
    if (!arrive(description.site)) return;
    described_sites_.insert(description.site);
    ended_sites_.erase(description.site);
}

void Reception::end(const bus::SiteDescription& gone) {
    if (described_sites_.erase(gone.site) == 0) return;
    ended_sites_.insert(gone.site);
    leave(gone.site);
}

void Reception::put(bus::SiteMesh&& mesh, Timestamp written) {
    if (ended_sites_.contains(mesh.site) || !arrive(mesh.site)) return;
    const Timestamp delays_from = bus::delays_from(mesh.capture_time, written);
    preparation_.put(std::move(mesh), delays_from);
}

void Reception::end(const bus::SiteMesh& gone) {
    ended_sites_.erase(gone.site);
    if (!described_sites_.contains(gone.site)) return leave(gone.site);
    preparation_.lose(gone.site);
}

}  // namespace atrium::world_server
