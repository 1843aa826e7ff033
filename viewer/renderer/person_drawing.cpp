#include "viewer/renderer/person_drawing.hpp"

#include "viewer/renderer/shaders.hpp"

#include <Eigen/LU>
#include <glad/gl.h>

#include <string>
#include <utility>

namespace atrium::renderer {
namespace {

void describe_group(std::size_t num_cameras) {
    const std::size_t stride = floats_per_vertex(num_cameras) * sizeof(float);
    gl::float_attribute(0, 3, stride, 0);
    gl::float_attribute(1, 3, stride, 3 * sizeof(float));
    unsigned index = 2;
    std::size_t offset = 6 * sizeof(float);
    for (std::size_t i = 0; i < num_cameras / 2; ++i, offset += 2 * sizeof(float))
        gl::float_attribute(index++, 2, stride, offset);
    for (std::size_t i = 0; i < num_cameras; ++i, offset += 4 * sizeof(float))
        gl::float_attribute(index++, 4, stride, offset);
}

}  // namespace

Expected<PersonShaders> PersonShaders::create() {
    PersonShaders shaders;
    for (std::size_t g = 0; g < kCamerasPerTriangle.size(); ++g) {
        const std::size_t n = kCamerasPerTriangle[g];
        auto program = gl::ShaderProgram::create("person of " + std::to_string(n) + " cameras",
                                                 shaders::person_vertex(n),
                                                 shaders::person_fragment(n));
        if (!program) return tl::unexpected(program.error());
        shaders.by_group[g] = std::move(*program);
    }
    return shaders;
}

PersonDrawing::PersonDrawing()
    : surface_layout_(gl::make_vertex_array()),
      surface_vertices_(gl::make_buffer()),
      surface_indices_(gl::make_buffer()) {
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        groups_[g] = {gl::make_vertex_array(), gl::make_buffer()};
        glBindVertexArray(groups_[g].layout.id());
        glBindBuffer(GL_ARRAY_BUFFER, groups_[g].vertices.id());
        describe_group(kCamerasPerTriangle[g]);
    }
    glBindVertexArray(surface_layout_.id());
    glBindBuffer(GL_ARRAY_BUFFER, surface_vertices_.id());
    gl::float_attribute(0, 3, sizeof(Eigen::Vector3f), 0);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, surface_indices_.id());
    glBindVertexArray(0);
}

PersonModel PersonDrawing::set_model(PersonModel model) {
    std::swap(model_, model);
    is_blended_ = false;
    opacity_ = 1.0;
    upload_pictures();
    glBindVertexArray(surface_layout_.id());
    gl::upload(surface_vertices_,
               GL_ARRAY_BUFFER,
               std::span<const Eigen::Vector3f>(model_.vertices_site),
               GL_STREAM_DRAW);
    gl::upload(surface_indices_,
               GL_ELEMENT_ARRAY_BUFFER,
               std::span<const std::array<std::uint32_t, 3>>(model_.triangles),
               GL_STREAM_DRAW);
    glBindVertexArray(0);
    return model;
}

void PersonDrawing::set_pose(const Eigen::Matrix4d& world_from_site) {
    world_from_site_ = world_from_site;
}

void PersonDrawing::upload_pictures() {
    const std::array<int, 3> size = {
        model_.layer_width, model_.layer_height, static_cast<int>(model_.cameras.size())};
    if (size[2] == 0) return;
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    if (!pictures_ || size != pictures_size_) {
        GLuint id = 0;
        glGenTextures(1, &id);
        pictures_ = gl::Texture(id);
        pictures_size_ = size;
        glBindTexture(GL_TEXTURE_2D_ARRAY, id);
        glTexImage3D(GL_TEXTURE_2D_ARRAY,
                     0,
                     GL_RGBA8,
                     size[0],
                     size[1],
                     size[2],
                     0,
                     GL_RGBA,
                     GL_UNSIGNED_BYTE,
                     model_.layers.data());
        glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
        return;
    }
    glBindTexture(GL_TEXTURE_2D_ARRAY, pictures_.id());
    glTexSubImage3D(GL_TEXTURE_2D_ARRAY,
                    0,
                    0,
                    0,
                    0,
                    size[0],
                    size[1],
                    size[2],
                    GL_RGBA,
                    GL_UNSIGNED_BYTE,
                    model_.layers.data());
}

void PersonDrawing::blend(const Eigen::Vector3f& eye_site) {
    if (is_blended_ && eye_site == blended_eye_site_) return;
    blend_for_view(model_, eye_site, scratch_, blended_);
    is_blended_ = true;
    blended_eye_site_ = eye_site;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        const BlendGroup& group = blended_.groups[g];
        const std::size_t num_floats =
            group.num_vertices * floats_per_vertex(kCamerasPerTriangle[g]);
        gl::upload(groups_[g].vertices,
                   GL_ARRAY_BUFFER,
                   std::span<const float>(group.data.data(), num_floats),
                   GL_STREAM_DRAW);
    }
}

void PersonDrawing::draw(const PersonShaders& shaders,
                         const Eigen::Matrix4d& clip_from_world,
                         const Eigen::Vector3d& eye_world) {
    if (model_.triangles.empty()) return;
    const Eigen::Vector4d eye_site = world_from_site_.inverse() * eye_world.homogeneous();
    blend(eye_site.head<3>().cast<float>());
    const Eigen::Matrix4f clip_from_site = (clip_from_world * world_from_site_).cast<float>();
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D_ARRAY, pictures_.id());
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        if (blended_.groups[g].num_vertices == 0) continue;
        shaders.by_group[g].use();
        shaders.by_group[g].set("clip_from_site", clip_from_site);
        shaders.by_group[g].set("pictures", 0);
        glBindVertexArray(groups_[g].layout.id());
        glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(blended_.groups[g].num_vertices));
    }
}

void PersonDrawing::draw_surface(const gl::ShaderProgram& shader) const {
    if (model_.triangles.empty()) return;
    shader.set("world_from_object", Eigen::Matrix4f(world_from_site_.cast<float>()));
    glBindVertexArray(surface_layout_.id());
    glDrawElements(
        GL_TRIANGLES, static_cast<GLsizei>(3 * model_.triangles.size()), GL_UNSIGNED_INT, nullptr);
}

}  // namespace atrium::renderer
