#pragma once

#include "core/gl/resources.hpp"
#include "viewer/renderer/object_look.hpp"
#include "viewer/renderer/soft_surface.hpp"

#include <array>
#include <cstddef>
#include <span>

namespace atrium::renderer {

/// One object in GL's memory.
struct ObjectDrawing {
    struct Level {
        std::size_t first = 0;  // in `indices`
        int num_indices = 0;
    };

    ObjectLook look;
    gl::VertexArray layout;
    gl::Buffer corners;
    gl::Buffer indices;
    std::array<Level, 3> levels;  // ever fewer triangles
    double radius_m = 0.0;        // around its origin, of all that it is

    /// With the shader in use, where it is `radius_px` large: with as many triangles as make no
    /// difference there.
    void draw(double radius_px) const;
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
