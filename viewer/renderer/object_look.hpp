#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "viewer/renderer/shape_mesh.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace atrium::renderer {

/// A picture that lies on things: 8-bit RGBA, sRGB, rows from the top. Where it is transparent, the
/// thing's colour is seen.
struct TexturePicture {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> rgba;
};

/// A rigid object of the scene.
struct ObjectLook {
    /// What it looks like, in its own frame [m]; null: as `shape` and `size_m` say.
    std::shared_ptr<const ShapeMesh> model = nullptr;
    ShapeKind shape = ShapeKind::kBox;
    Eigen::Vector3d size_m = Eigen::Vector3d::Ones();         // as `make_shape` takes it
    Eigen::Vector3d colour = Eigen::Vector3d::Constant(0.7);  // linear RGB in [0, 1]
    /// Name of the picture on it (SceneRenderer::set_texture); while there is none of that name,
    /// the plain colour is seen.
    std::string texture = {};
    geometry::RigidTransform world_from_object = {};
};

}  // namespace atrium::renderer
