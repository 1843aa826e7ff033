#pragma once

#include "core/gl/resources.hpp"
#include "viewer/renderer/object/object_mesh.hpp"
#include "viewer/renderer/object/soft_surface.hpp"

#include <Eigen/Geometry>

#include <span>

namespace atrium::renderer {

/// One rigid object to draw.
struct ObjectDrawing {
    ObjectDrawing(ObjectLook object_look, ObjectMeshes& meshes);

    ObjectLook look;
    ScaledMesh scaled;
    double radius_m = 0.0;  // of a sphere around its origin that contains it

    Eigen::Matrix4f world_from_mesh() const;
    bool is_floor() const {
        return look.model == nullptr && look.shape == ShapeKind::kPlane &&
               (look.world_from_object.rotation * Eigen::Vector3d::UnitZ()).z() > 0.99;
    }
};

/// A soft object in GL memory. Draws nothing before the first `move`.
struct SoftDrawing {
    explicit SoftDrawing(SoftLook soft_look);
    /// `nodes_world` must have as many nodes as the look.
    void move(std::span<const Eigen::Vector3f> nodes_world);
    void draw() const;

    SoftLook look;
    gl::VertexArray layout;
    gl::Buffer corners;
    gl::Buffer indices;
    ShapeMesh surface;  // scratch
    int num_indices = 0;
    Eigen::AlignedBox3f bounds;  // in the world
};

}  // namespace atrium::renderer
