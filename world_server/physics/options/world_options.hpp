#pragma once

#include "core/geometry/aabb.hpp"
#include "world_server/physics/options/people_options.hpp"
#include "world_server/physics/options/rigid_options.hpp"
#include "world_server/physics/options/soft_options.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <optional>

namespace atrium::physics {

/// Action for an object whose centre of mass leaves the world's box.
enum class LeavePolicy : std::uint8_t {
    kReset,   // returns to its start pose
    kRemove,  // is removed
    // cannot leave: the box has walls; an object that gets through one returns to its start
    kBounce
};

/// Options and tuned constants of a world. Those of people, rigid and soft objects are in
/// the headers beside this one.
struct WorldOptions {
    double tick_s = 1.0 / 120.0;
    Eigen::Vector3d gravity{0.0, 0.0, -9.81};  // [m/s^2]
    std::size_t max_objects = 256;
    double half_extent_m = 20.0;          // half size of the world's box around the origin
    double lowest_z_m = -1.0;             // lower end of the box
    std::optional<geometry::Aabb> box{};  // replaces the two above
    LeavePolicy leaving = LeavePolicy::kReset;
    double max_speed_mps = 15.0;         // of an object
    double max_spin_rad_s = 60.0;        // of an object
    double max_depenetration_mps = 3.0;  // speed at which overlapping objects separate
    // Overlap above which Bullet separates without adding velocity. Bullet's default of 4 cm makes
    // an object pressed by a hand pop away.
    float plain_contact_m = 0.002F;
    int solver_iterations = 20;  // an object clasped between two palms needs force from both
    double wall_friction = 0.5;  // of the box, for LeavePolicy::kBounce
    double wall_restitution = 0.5;
    // An object beyond these limits returns to its start. No cause adds more than a few times
    // max_speed_mps in one tick.
    double runaway_factor = 4.0;  // speed, in max_speed_mps
    double torn_m = 0.25;         // gap of a joint
    double behind_wall_m = 0.5;   // LeavePolicy::kBounce: distance outside the box
    PeopleOptions people{};
    RigidOptions rigid{};
    SoftOptions soft{};
};

/// The world's box: `options.box`, or a box around the origin from the half extent.
geometry::Aabb box_of(const WorldOptions& options);

}  // namespace atrium::physics
