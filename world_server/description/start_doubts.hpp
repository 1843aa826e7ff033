#pragma once

#include "core/geometry/aabb.hpp"
#include "world_server/description/world_description.hpp"

#include <functional>
#include <string>
#include <vector>

namespace atrium::world_server {

/// Returns the bounding box of a box after a motion.
geometry::Aabb moved(const geometry::RigidTransform& to_from, const geometry::Aabb& box);

/// Returns the bounding box of an object at its start, in the world; a plane's is infinite.
geometry::Aabb start_box_of(const physics::RigidObject& object);

/// Returns the bounding box of a soft object's nodes at its start, in the world.
geometry::Aabb start_box_of(const physics::SoftObject& soft);

/// True if a joint without `collide` connects two objects.
bool pass_through(const WorldDescription& world, std::uint32_t a, std::uint32_t b);

/// True if two boxes have a place in common.
bool touch(const geometry::Aabb& a, const geometry::Aabb& b);

/// What starts deeper than this inside something is doubted.
inline constexpr double kDeepRigid_m = 0.05;
inline constexpr double kDeepSoft_m = 0.03;

/// An object that starts deep inside something.
struct DeepStart {
    const WorldObject* object = nullptr;
    double depth_m = 0.0;
    std::string in_what;  // "floor, which is fixed"
    std::string cure;
};

using DepthOfPose = std::function<double(const physics::RigidObject& pose)>;

/// Returns what to do about an object that starts deep inside something.
std::string cure_of(const WorldObject& object, const DepthOfPose& depth_m);

/// Adds a line for each object; for all parts of a puppet one, that of the deepest part.
void add_lines(const std::vector<DeepStart>& starts, std::vector<std::string>& lines);

/// A joint or tie this far from its object is doubted.
inline constexpr double kFarAnchor_m = 0.5;

/// Returns the distance of a place in the world from the object's box at its start [m].
double distance_m(const Eigen::Vector3d& place_m, const physics::RigidObject& object);

/// Adds a line for each moving object that starts inside another object, unless a joint
/// without `collide` connects the two; and for each fixed object and each site outside the world's
/// bounds.
void doubt_starts(const WorldDescription& world, std::vector<std::string>& lines);

/// Adds a line for each joint between two objects whose anchor is far from both of them, or, unless
/// a slider, far from one that moves and does not hang below it.
void doubt_anchors(const WorldDescription& world, std::vector<std::string>& lines);

}  // namespace atrium::world_server
