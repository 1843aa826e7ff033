#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "viewer/renderer/shape_mesh.hpp"

#include <Eigen/Core>

#include <memory>

namespace atrium::renderer {

/// A rigid object of the scene.
struct ObjectLook {
    /// What it looks like, in its own frame [m]; null: as `shape` and `size_m` say.
    std::shared_ptr<const ShapeMesh> model = nullptr;
    ShapeKind shape = ShapeKind::kBox;
    Eigen::Vector3d size_m = Eigen::Vector3d::Ones();         // as `make_shape` takes it
    Eigen::Vector3d colour = Eigen::Vector3d::Constant(0.7);  // linear RGB in [0, 1]
    geometry::RigidTransform world_from_object = {};
};

}  // namespace atrium::renderer
