#pragma once

#include "core/bus/messages.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "world_server/physics/rigid_object.hpp"

#include <memory>
#include <vector>

namespace atrium::world_server {

/// One object of the world as its file describes it. Ids are the places in the file, counted from
/// 1; the parts of puppets come after all objects.
struct WorldObject {
    bus::SceneObject scene;
    double rolling_friction_m = 0.0005;
    double drag_per_s = 0.02;
    /// Convex, compound: as physics::RigidObject has them; else null.
    std::shared_ptr<const std::vector<geometry::TriangleMesh>> parts{};
};

physics::RigidObject to_rigid(const WorldObject& object);

/// What every viewer loads for itself, and what of it is solid for things.
struct WorldScenery {
    bus::Scenery scene;
    bool is_solid = false;
    double friction = 0.6;
    double restitution = 0.2;
    geometry::TriangleMesh mesh;  // in the world [m]; empty where it is not solid
};

}  // namespace atrium::world_server
