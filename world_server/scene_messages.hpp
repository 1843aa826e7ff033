#pragma once

#include "core/bus/messages.hpp"
#include "world_server/description/soft_objects.hpp"
#include "world_server/description/world_object.hpp"
#include "world_server/physics/rigid/rigid_object.hpp"

/// Converts between the described world, the physics and messages.
namespace atrium::world_server {

bus::SceneObject to_message(const WorldObject& object);
/// `size_m`: full extents of the nodes at the start [m].
bus::SceneObject to_message(const WorldSoftObject& object, const Eigen::Vector3d& size_m);
bus::Scenery to_message(const WorldScenery& scenery);

/// Converts an object of a command. It must not be soft and has no parts.
physics::RigidObject to_rigid(const bus::SceneObject& object);

}  // namespace atrium::world_server
