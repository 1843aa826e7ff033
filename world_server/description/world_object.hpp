#pragma once

#include "core/bus/messages.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "world_server/physics/rigid/rigid_object.hpp"

#include <memory>
#include <vector>

namespace atrium::world_server {

/// An object as described in the world file. Ids are positions in the file, from 1. Parts of
/// puppets come after all objects.
struct WorldObject {
    bus::SceneObject scene;
    double rolling_friction_m = 0.0005;
    double drag_per_s = 0.02;
    /// Convex, compound: see physics::RigidObject. Otherwise null.
    std::shared_ptr<const std::vector<geometry::TriangleMesh>> parts{};
};

physics::RigidObject to_rigid(const WorldObject& object);

/// Scenery: loaded by every viewer, optionally solid.
struct WorldScenery {
    bus::Scenery scene;
    bool is_solid = false;
    double friction = 0.6;
    double restitution = 0.2;
    geometry::TriangleMesh mesh;  // in the world [m]; empty if not solid
};

}  // namespace atrium::world_server
