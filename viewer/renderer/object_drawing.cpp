#include "viewer/renderer/object_drawing.hpp"

#include <glad/gl.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

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
                         .levels = {}};
    std::vector<std::uint32_t> indices = mesh.indices;
    object.levels.fill({0, static_cast<int>(indices.size())});
    for (std::size_t i = 0; i < mesh.coarser.size(); ++i) {
        const auto& coarse = mesh.coarser[i];
        if (coarse.empty()) continue;
        object.levels[i + 1] = {indices.size(), static_cast<int>(coarse.size())};
        indices.insert(indices.end(), coarse.begin(), coarse.end());
    }
    for (const ShapeMesh::Corner& corner : mesh.corners)
        object.radius_m =
            std::max(object.radius_m, static_cast<double>(corner.position_object.norm()));
    glBindVertexArray(object.layout.id());
    gl::upload(object.corners,
               GL_ARRAY_BUFFER,
               std::span<const ShapeMesh::Corner>(mesh.corners),
               GL_STATIC_DRAW);
    read_corners();
    gl::upload(object.indices,
               GL_ELEMENT_ARRAY_BUFFER,
               std::span<const std::uint32_t>(indices),
               GL_STATIC_DRAW);
    glBindVertexArray(0);
    return object;
}

void ObjectDrawing::draw(double radius_px) const {
    // the outline of a circle of 32, 16 or 8 sides is within a quarter of a pixel there
    const std::size_t level = radius_px > 12.0 ? 0 : radius_px > 3.0 ? 1 : 2;
    glBindVertexArray(layout.id());
    glDrawElements(GL_TRIANGLES,
                   levels[level].num_indices,
                   GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(levels[level].first * sizeof(std::uint32_t)));
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
