#include "viewer/renderer/object/object_mesh.hpp"

#include <glad/gl.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::renderer {
namespace {

constexpr unsigned kColourAttribute = 8;  // after those of the instances

ObjectMesh upload(const ShapeMesh& mesh) {
    ObjectMesh drawn{.layout = gl::make_vertex_array(),
                     .corners = gl::make_buffer(),
                     .indices = gl::make_buffer(),
                     .colours = gl::make_buffer(),
                     .has_colours = !mesh.colours.empty(),
                     .levels = {}};
    std::vector<std::uint32_t> indices = mesh.indices;
    drawn.levels.fill({0, static_cast<int>(indices.size())});
    for (std::size_t i = 0; i < mesh.coarser.size(); ++i) {
        const auto& coarse = mesh.coarser[i];
        if (coarse.empty()) continue;
        drawn.levels[i + 1] = {indices.size(), static_cast<int>(coarse.size())};
        indices.insert(indices.end(), coarse.begin(), coarse.end());
    }
    for (const ShapeMesh::Corner& corner : mesh.corners) {
        drawn.half_extent =
            drawn.half_extent.cwiseMax(corner.position_object.cwiseAbs().cast<double>());
    }
    glBindVertexArray(drawn.layout.id());
    gl::upload(drawn.corners,
               GL_ARRAY_BUFFER,
               std::span<const ShapeMesh::Corner>(mesh.corners),
               GL_STATIC_DRAW);
    read_corners();
    if (drawn.has_colours) {
        gl::upload(drawn.colours,
                   GL_ARRAY_BUFFER,
                   std::span<const Eigen::Vector3f>(mesh.colours),
                   GL_STATIC_DRAW);
        gl::float_attribute(kColourAttribute, 3, sizeof(Eigen::Vector3f), 0);
    }
    gl::upload(drawn.indices,
               GL_ELEMENT_ARRAY_BUFFER,
               std::span<const std::uint32_t>(indices),
               GL_STATIC_DRAW);
    glBindVertexArray(0);
    return drawn;
}

// Size of the shared mesh, which `scale_of` scales to the object. It depends on the object where a
// scale would distort: a capsule keeps round caps, and a texture on a plane repeats once per metre.
Eigen::Vector3d own_size(const ObjectLook& look) {
    constexpr double kLongest = 1e6;
    if (look.shape == ShapeKind::kCapsule)
        return {1.0, 1.0, std::clamp(look.size_m.z() / look.size_m.x(), 1.0, kLongest)};
    if (look.shape == ShapeKind::kPlane) return look.size_m;
    return Eigen::Vector3d::Ones();
}

Eigen::Vector3d scale_of(const ObjectLook& look) {
    switch (look.shape) {
        case ShapeKind::kBox:
            return look.size_m;
        case ShapeKind::kCylinder:
            return {look.size_m.x(), look.size_m.x(), look.size_m.z()};
        case ShapeKind::kSphere:
        case ShapeKind::kCapsule:
            return Eigen::Vector3d::Constant(look.size_m.x());
        case ShapeKind::kPlane:
            break;
    }
    return Eigen::Vector3d::Ones();
}

}  // namespace

std::size_t ObjectMesh::level_of(double radius_px) {
    // the outline of a circle of 32, 16 or 8 sides then is within a quarter of a pixel
    return radius_px > 12.0 ? 0 : radius_px > 3.0 ? 1 : 2;
}

void read_corners() {
    using Corner = ShapeMesh::Corner;
    gl::float_attribute(0, 3, sizeof(Corner), 0);
    gl::float_attribute(1, 3, sizeof(Corner), sizeof(Eigen::Vector3f));
    gl::float_attribute(2, 2, sizeof(Corner), 2 * sizeof(Eigen::Vector3f));
}

ScaledMesh ObjectMeshes::of(const ObjectLook& look) {
    if (look.model != nullptr)
        return {find({look.model.get(), ShapeKind::kBox, 0.0, 0.0, 0.0}, look)};
    const Eigen::Vector3d size = own_size(look);
    return {find({nullptr, look.shape, size.x(), size.y(), size.z()}, look), scale_of(look)};
}

std::shared_ptr<const ObjectMesh> ObjectMeshes::find(const Key& key, const ObjectLook& look) {
    if (meshes_.size() >= purge_at_) {
        std::erase_if(meshes_, [](const auto& known) { return known.second.expired(); });
        purge_at_ = 2 * meshes_.size() + 64;
    }
    std::weak_ptr<const ObjectMesh>& known = meshes_[key];
    if (auto mesh = known.lock()) return mesh;
    const auto mesh = std::make_shared<const ObjectMesh>(
        upload(look.model != nullptr ? *look.model : make_shape(look.shape, own_size(look))));
    known = mesh;
    return mesh;
}

}  // namespace atrium::renderer
