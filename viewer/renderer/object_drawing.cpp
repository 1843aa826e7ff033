#include "viewer/renderer/object_drawing.hpp"

#include <glad/gl.h>

#include <utility>

namespace atrium::renderer {

namespace {

// Of the bound vertex array, from the bound buffer of corners.
void read_corners() {
    using Corner = ShapeMesh::Corner;
    gl::float_attribute(0, 3, sizeof(Corner), 0);
    gl::float_attribute(1, 3, sizeof(Corner), sizeof(Eigen::Vector3f));
    gl::float_attribute(2, 2, sizeof(Corner), 2 * sizeof(Eigen::Vector3f));
}

}  // namespace

ObjectDrawing make_object(const ObjectLook& look) {
    const ShapeMesh own = look.model == nullptr ? make_shape(look.shape, look.size_m) : ShapeMesh{};
    const ShapeMesh& mesh = look.model == nullptr ? own : *look.model;
    ObjectDrawing object{.look = look,
                         .layout = gl::make_vertex_array(),
                         .corners = gl::make_buffer(),
                         .indices = gl::make_buffer(),
                         .num_indices = static_cast<int>(mesh.indices.size())};
    glBindVertexArray(object.layout.id());
    gl::upload(object.corners,
               GL_ARRAY_BUFFER,
               std::span<const ShapeMesh::Corner>(mesh.corners),
               GL_STATIC_DRAW);
    read_corners();
    gl::upload(object.indices,
               GL_ELEMENT_ARRAY_BUFFER,
               std::span<const std::uint32_t>(mesh.indices),
               GL_STATIC_DRAW);
    glBindVertexArray(0);
    return object;
}

void ObjectDrawing::draw() const {
    glBindVertexArray(layout.id());
    glDrawElements(GL_TRIANGLES, num_indices, GL_UNSIGNED_INT, nullptr);
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
