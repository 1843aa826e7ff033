#pragma once

#include "core/gl/resources.hpp"
#include "viewer/renderer/object_look.hpp"

namespace atrium::renderer {

/// One object in GL's memory.
struct ObjectDrawing {
    ObjectLook look;
    gl::VertexArray layout;
    gl::Buffer corners;
    gl::Buffer indices;
    int num_indices = 0;

    bool is_floor() const {
        return look.shape == ShapeKind::kPlane &&
               (look.world_from_object.rotation * Eigen::Vector3d::UnitZ()).z() > 0.99;
    }
};

ObjectDrawing make_object(const ObjectLook& look);

}  // namespace atrium::renderer
