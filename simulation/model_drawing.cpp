#include "simulation/model_drawing.hpp"

#include <glad/gl.h>

#include <span>

namespace atrium::simulation {
namespace {

template <typename Vector>
void static_attribute(const gl::Buffer& buffer,
                      unsigned index,
                      const std::vector<Vector>& values,
                      unsigned usage) {
    gl::upload(buffer, GL_ARRAY_BUFFER, std::span<const Vector>(values), usage);
    gl::float_attribute(index, Vector::RowsAtCompileTime, sizeof(Vector), 0);
}

}  // namespace

ModelDrawing::ModelDrawing(const ModelSurface& surface) : parts_(surface.parts) {
    array_ = gl::make_vertex_array();
    for (gl::Buffer* buffer : {&positions_, &normals_, &texture_places_, &colours_, &indices_})
        *buffer = gl::make_buffer();
    glBindVertexArray(array_.id());
    // right size, content undefined until the first pose
    static_attribute(positions_, 0, surface.colours, GL_STREAM_DRAW);
    static_attribute(normals_, 1, surface.colours, GL_STREAM_DRAW);
    static_attribute(texture_places_, 3, surface.texture_places, GL_STATIC_DRAW);
    static_attribute(colours_, 4, surface.colours, GL_STATIC_DRAW);
    gl::upload(indices_, GL_ELEMENT_ARRAY_BUFFER, std::span(surface.triangles), GL_STATIC_DRAW);
    const gl::TextureOptions options{
        .format = gl::PixelFormat::kRgba8, .linear = true, .repeat = true};
    for (const ModelTexture& texture : surface.textures) {
        textures_.push_back(gl::make_texture(texture.width, texture.height, options));
        gl::upload_pixels(textures_.back(),
                          options.format,
                          0,
                          0,
                          texture.width,
                          texture.height,
                          texture.rgba.data());
    }
}

void ModelDrawing::set_pose(const PosedSkin& skin) {
    gl::upload(positions_,
               GL_ARRAY_BUFFER,
               std::span<const Eigen::Vector3f>(skin.positions),
               GL_STREAM_DRAW);
    gl::upload(
        normals_, GL_ARRAY_BUFFER, std::span<const Eigen::Vector3f>(skin.normals), GL_STREAM_DRAW);
}

void ModelDrawing::draw(const gl::ShaderProgram& program) const {
    glBindVertexArray(array_.id());
    program.set("surface", 0);
    for (const ModelPart& part : parts_) {
        program.set("has_surface", part.texture >= 0 ? 1 : 0);
        program.set("is_cut_out", part.is_cut_out ? 1 : 0);
        if (part.texture >= 0)
            gl::bind_texture(0, textures_[static_cast<std::size_t>(part.texture)]);
        glDrawElements(
            GL_TRIANGLES,
            static_cast<GLsizei>(3 * part.num_triangles),
            GL_UNSIGNED_INT,
            reinterpret_cast<const void*>(3 * sizeof(std::uint32_t) * part.first_triangle));
    }
}

}  // namespace atrium::simulation
