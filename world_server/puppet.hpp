#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "world_server/description/world_object.hpp"
#include "world_server/physics/joint.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <string>
#include <vector>

namespace atrium::world_server {

/// A jointed figure: pelvis, chest, head, and of each side upper arm, forearm, thigh, shin and
/// foot. It has no strength of its own: it hangs, sits and falls as it is held.
struct PuppetDescription {
    std::string name;
    /// Its origin is on the floor between its feet; it stands along +z, looks along +x, and its
    /// arms point out and down.
    geometry::RigidTransform world_from_puppet{};
    double height_m = 0.6;
    double density_kg_per_m3 = 300.0;
    double friction = 0.7;
    Eigen::Vector3d colour{0.55, 0.14, 0.12};       // of the trunk, linear RGB
    Eigen::Vector3d limb_colour{0.13, 0.17, 0.42};  // arms, legs
    Eigen::Vector3d head_colour{0.80, 0.52, 0.36};
    double string_m =
        0.0;  // length of strings by which head and hands hang from the world; 0: none
};

inline constexpr std::size_t kNumPuppetParts = 13;

struct Puppet {
    std::vector<WorldObject> parts;  // ids from `first_id` on; names are `<puppet>.<part>`
    std::vector<physics::Joint> joints;
};

/// The same description gives the same parts in the same order.
Puppet make_puppet(const PuppetDescription& description, std::uint32_t first_id);

}  // namespace atrium::world_server
