#include "viewer/renderer/object/object_drawing.hpp"

#include <glad/gl.h>

#include <utility>

namespace atrium::renderer {

ObjectDrawing::ObjectDrawing(ObjectLook object_look, ObjectMeshes& meshes)
    : look(std::move(object_look)), scaled(meshes.of(look)) {
    const bool is_ball = look.model == nullptr && look.shape == ShapeKind::kSphere;
    const Eigen::Vector3d half_m = scaled.mesh->half_extent.cwiseProduct(scaled.scale);
    radius_m = is_ball ? half_m.x() : half_m.norm();
}

Eigen::Matrix4f ObjectDrawing::world_from_mesh() const {
    Eigen::Matrix4d m = look.world_from_object.matrix();
    for (Eigen::Index i = 0; i < 3; ++i) m.col(i) *= scaled.scale[i];
    return m.cast<float>();
}

SoftDrawing::SoftDrawing(SoftLook soft_look)
    : look(std::move(soft_look)),
      layout(gl::make_vertex_array()),
      corners(gl::make_buffer()),
      indices(gl::make_buffer()) {}

void SoftDrawing::move(std::span<const Eigen::Vector3f> nodes_world) {
    if (!look.texture.empty() && look.texture_places.empty())
        look.texture_places = make_texture_places(look, nodes_world);
    make_soft_surface(look, nodes_world, surface);
    num_indices = static_cast<int>(surface.indices.size());
    bounds.setEmpty();
    for (const ShapeMesh::Corner& corner : surface.corners) bounds.extend(corner.position_object);
    glBindVertexArray(layout.id());
    gl::upload(corners,
               GL_ARRAY_BUFFER,
               std::span<const ShapeMesh::Corner>(surface.corners),
               GL_STREAM_DRAW);
    read_corners();
    gl::upload(indices,
               GL_ELEMENT_ARRAY_BUFFER,
               std::span<const std::uint32_t>(surface.indices),
               GL_STREAM_DRAW);
    glBindVertexArray(0);
}

void SoftDrawing::draw() const {
    glBindVertexArray(layout.id());
    glDrawElements(GL_TRIANGLES, num_indices, GL_UNSIGNED_INT, nullptr);
}

}  // namespace atrium::renderer
