#pragma once

#include "core/geometry/rigid_transform.hpp"

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace atrium::world_server {

struct NamedPlacement {
    std::string site;
    geometry::RigidTransform world_from_site;
};

/// Decides where in the world each site stands.
///
/// A site that the world file names stands where the file says. Any other gets the next free place
/// on a ring around the world's origin and faces it (its +X points there): radius 1.8 m at 90, 270,
/// 45, 135, 225, 315, 0 and 180 degrees from +X, then the same at 3.6 m, and so on. A site keeps
/// its place when it leaves, and has it again when it returns.
class SitePlacer {
public:
    SitePlacer(const std::vector<NamedPlacement>& named, std::size_t max_sites);

    /// nullopt: the world has its largest number of sites.
    std::optional<geometry::RigidTransform> place(const std::string& site);

private:
    std::map<std::string, geometry::RigidTransform> world_from_site_;
    std::size_t max_sites_;
    std::size_t num_on_ring_ = 0;
};

}  // namespace atrium::world_server
