#include "viewer/renderer/object_drawing.hpp"

#include <glad/gl.h>

namespace atrium::renderer {

ObjectDrawing make_object(const ObjectLook& look) {
    const ShapeMesh mesh = make_shape(look.shape, look.size_m);
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
    gl::float_attribute(0, 3, sizeof(ShapeMesh::Corner), 0);
    gl::float_attribute(1, 3, sizeof(ShapeMesh::Corner), sizeof(Eigen::Vector3f));
    gl::upload(object.indices,
               GL_ELEMENT_ARRAY_BUFFER,
               std::span<const std::uint32_t>(mesh.indices),
               GL_STATIC_DRAW);
    glBindVertexArray(0);
    return object;
}

}  // namespace atrium::renderer
