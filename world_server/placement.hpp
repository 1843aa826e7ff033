#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "world_server/description/site_placements.hpp"

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace atrium::world_server {

/// Assigns each site its place in the world.
///
/// A site named in the world file gets the place stated there. Any other site gets the next free
/// place on a ring around the world's origin and faces the origin (its +X points there): radius 1.8
/// m at 90, 270, 45, 135, 225, 315, 0 and 180 degrees from +X, then the same angles at 3.6 m, and
/// so on. A site that leaves and returns gets the same place.
class SitePlacer {
public:
    SitePlacer(const std::vector<NamedPlacement>& named, std::size_t max_sites);

    /// Returns the site's place; nullopt if the world is full.
    std::optional<geometry::RigidTransform> place(const std::string& site);

private:
    std::map<std::string, geometry::RigidTransform> world_from_site_;
    std::size_t max_sites_;
    std::size_t num_on_ring_ = 0;
};

}  // namespace atrium::world_server
