#pragma once

#include "core/gl/resources.hpp"
#include "viewer/renderer/object_look.hpp"
#include "viewer/renderer/soft_surface.hpp"

#include <span>

namespace atrium::renderer {

/// One object in GL's memory.
struct ObjectDrawing {
    ObjectLook look;
    gl::VertexArray layout;
    gl::Buffer corners;
    gl::Buffer indices;
    int num_indices = 0;

    /// With the shader in use.
    void draw() const;
    bool is_floor() const {
        return look.model == nullptr && look.shape == ShapeKind::kPlane &&
               (look.world_from_object.rotation * Eigen::Vector3d::UnitZ()).z() > 0.99;
    }
};

ObjectDrawing make_object(const ObjectLook& look);

/// A soft object in GL's memory; nothing is drawn before its nodes are known.
struct SoftDrawing {
    explicit SoftDrawing(SoftLook soft_look);
    /// As many nodes as the look has.
    void move(std::span<const Eigen::Vector3f> nodes_world);
    void draw() const;

    SoftLook look;
    gl::VertexArray layout;
    gl::Buffer corners;
    gl::Buffer indices;
    ShapeMesh surface;  // scratch
    int num_indices = 0;
};

}  // namespace atrium::renderer
