#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "world_server/physics/person_shape.hpp"
#include "world_server/placement.hpp"

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace atrium::world_server {

/// The sites that are there: where they stand, and what their newest mesh is to the physics. Not
/// thread-safe; no network.
class SiteRegister {
public:
    SiteRegister(const std::vector<NamedPlacement>& named,
                 std::size_t max_sites,
                 const physics::PersonShapeOptions& options);

    /// The site is there. Returns its placement when it was not there before. Fails with
    /// kUnavailable when the world has its largest number of sites.
    Expected<std::optional<bus::SitePlacement>> arrive(const std::string& site);

    /// Nobody is in the site: nullopt. Fails with kInvalidData on a mesh that cannot be decoded,
    /// reaches further than 15 m from the site's origin, or was captured before the last one. The
    /// site must have arrived.
    Expected<std::optional<physics::PersonShape>> read_mesh(const bus::SiteMesh& message);

    /// The site's meshes ceased, and so did the person.
    void lose_mesh(const std::string& site);
    bool leave(const std::string& site);  // false: it was not there

    std::size_t num_present() const { return sites_.size(); }

private:
    struct Site {
        geometry::RigidTransform world_from_site;
        physics::PersonShaper shaper;
        Timestamp last_capture;
    };
    SitePlacer placer_;
    physics::PersonShapeOptions options_;
    std::map<std::string, Site> sites_;
};

}  // namespace atrium::world_server
