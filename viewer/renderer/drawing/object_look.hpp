#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "viewer/renderer/drawing/shape_mesh.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace atrium::renderer {

/// A texture: 8-bit RGBA, sRGB, top row first. Transparent texels show the object's colour.
struct TexturePicture {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> rgba;
};

/// Look and pose of a rigid object.
struct ObjectLook {
    /// Mesh in the object's frame [m]. Null: `shape` and `size_m` define it.
    std::shared_ptr<const ShapeMesh> model = nullptr;
    ShapeKind shape = ShapeKind::kBox;
    Eigen::Vector3d size_m = Eigen::Vector3d::Ones();         // as in `make_shape`
    Eigen::Vector3d colour = Eigen::Vector3d::Constant(0.7);  // linear RGB in [0, 1]
    /// Name of the texture (SceneRenderer::set_texture). Drawn in the plain colour until that
    /// texture exists.
    std::string texture = {};
    geometry::RigidTransform world_from_object = {};
};

}  // namespace atrium::renderer
