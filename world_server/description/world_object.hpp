#pragma once

#include "core/base/fingerprint.hpp"
#include "core/geometry/aabb.hpp"
#include "core/geometry/rigid_transform.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "world_server/physics/rigid/rigid_object.hpp"

#include <Eigen/Core>

#include <memory>
#include <string>
#include <vector>

namespace atrium::world_server {

/// Describes how viewers draw an object or scenery. Files are in the world file's folder.
struct Look {
    std::string model{};                                      // file; empty: none
    double model_scale = 1.0;                                 // [m] per unit of the model
    std::string texture{};                                    // picture; empty: none
    Eigen::Vector3d colour = Eigen::Vector3d::Constant(0.7);  // linear RGB in [0, 1]
    std::string own_texture{};        // picture that the model's file names; viewers do not draw it
    std::string missing_materials{};  // file of the colours that the model's file names
    bool is_see_through = false;      // the model's file has transparent parts
    /// Colours of the model's file, if the world file states neither colour nor texture for it.
    std::vector<Eigen::Vector3d> own_colours{};
    Fingerprint model_fingerprint{};  // of what was read; unknown: nothing
    Fingerprint texture_fingerprint{};
};

/// The surface of a convex or compound object's model, welded and facing outwards, in the object's
/// frame. Empty if it has more than pinholes, and for other shapes.
using ModelSurface = std::shared_ptr<const geometry::TriangleMesh>;

/// An object as described in the world file. Ids are positions in the file, from 1. Parts of
/// puppets come after all objects.
struct WorldObject {
    std::string name{};
    Look look{};
    /// As in the file: a compound may have one part, and a plane has the size of its drawn part.
    physics::RigidObject rigid{};
    std::string where{};   // place of its position in the file, for errors; empty: unknown
    std::string puppet{};  // name of the puppet that it is a part of; empty: none
    ModelSurface surface{};
};

/// Returns the object for the physics: a compound of one part becomes convex.
physics::RigidObject to_rigid(const WorldObject& object);

/// Scenery: loaded by every viewer, optionally solid.
struct WorldScenery {
    std::string name{};
    Look look{};
    bool is_colour_unused = false;  // the world file states one, but the model has its own
    geometry::RigidTransform world_from_model{};
    bool is_solid = false;
    double friction = 0.6;
    double restitution = 0.2;
    geometry::Aabb box{};           // around it, in the world
    geometry::TriangleMesh mesh{};  // in the world [m]; empty if too large to be solid
};

}  // namespace atrium::world_server
