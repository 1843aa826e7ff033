#pragma once

#include "core/geometry/aabb.hpp"
#include "world_server/description/world_description.hpp"

#include <string>
#include <vector>

namespace atrium::world_server {

/// Returns the bounding box of a box after a motion.
geometry::Aabb moved(const geometry::RigidTransform& to_from, const geometry::Aabb& box);

/// Returns the bounding box of an object at its start, in the world; a plane's is infinite.
geometry::Aabb start_box_of(const physics::RigidObject& object);

/// A joint or tie this far from its object is doubted.
inline constexpr double kFarAnchor_m = 0.5;

/// Returns the distance of a place in the world from the object's box at its start [m].
double distance_m(const Eigen::Vector3d& place_m, const physics::RigidObject& object);

/// Adds a line for each moving object that starts inside another object, unless a joint
/// without `collide` connects the two; for each moving one in the surface of solid scenery; and for
/// each fixed object and each site outside the world's bounds.
void doubt_starts(const WorldDescription& world, std::vector<std::string>& lines);

/// Adds a line for each joint between two objects whose anchor is far from both of them, or, unless
/// a slider, far from one that moves and does not hang below it.
void doubt_anchors(const WorldDescription& world, std::vector<std::string>& lines);

}  // namespace atrium::world_server
