#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "world_server/description/world_object.hpp"
#include "world_server/physics/rigid/joint.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <string>
#include <vector>

namespace atrium::world_server {

/// A jointed figure: pelvis, chest and head, and on each side upper arm, forearm, thigh, shin and
/// foot. It has no motors: it hangs, sits and falls passively.
struct PuppetDescription {
    std::string name;
    /// The origin is on the floor between the feet. The puppet stands along +z and looks along +x;
    /// its arms point outwards and down.
    geometry::RigidTransform world_from_puppet{};
    double height_m = 0.6;
    double density_kg_per_m3 = 300.0;
    double friction = 0.7;
    Eigen::Vector3d colour{0.55, 0.14, 0.12};       // trunk, linear RGB
    Eigen::Vector3d limb_colour{0.13, 0.17, 0.42};  // arms and legs
    Eigen::Vector3d head_colour{0.80, 0.52, 0.36};
    double string_m = 0.0;  // length of the strings that hold head and hands; 0: no strings
};

inline constexpr std::size_t kNumPuppetParts = 13;

struct Puppet {
    std::vector<WorldObject> parts;  // ids from `first_id`; names are `<puppet>.<part>`
    std::vector<physics::Joint> joints;
};

/// Creates a puppet. Deterministic, including the order of parts.
Puppet make_puppet(const PuppetDescription& description, std::uint32_t first_id);

}  // namespace atrium::world_server
