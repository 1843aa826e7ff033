#include "viewer/renderer/person/person_drawing.hpp"

#include "viewer/renderer/backdrop/backdrop.hpp"
#include "viewer/renderer/person/person_shader_text.hpp"

#include <Eigen/LU>
#include <glad/gl.h>

#include <algorithm>
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
    for (std::size_t i = 0; i < num_cameras; i += shaders::kLayersPerAttribute) {
        const std::size_t num_layers = std::min(num_cameras - i, shaders::kLayersPerAttribute);
        gl::float_attribute(index++, static_cast<int>(num_layers), stride, offset);
        offset += num_layers * sizeof(float);
    }
    for (std::size_t i = 0; i < num_cameras; ++i, offset += 4 * sizeof(float))
        gl::float_attribute(index++, 4, stride, offset);
}

// Calls write(to) with mapped memory for `num_floats` numbers. Reuses the buffer and enlarges it
// only when it is too small: a software renderer would clear a new buffer for each picture, and the
// system would map it anew.
template <typename Write>
void stream(std::size_t num_floats,
            const gl::Buffer& buffer,
            std::size_t& capacity,
            Write&& write) {
    if (num_floats == 0) return;
    glBindBuffer(GL_ARRAY_BUFFER, buffer.id());
    const std::size_t bytes = num_floats * sizeof(float);
    if (capacity < bytes) {
        capacity = bytes + bytes / 2;
        glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(capacity), nullptr, GL_STREAM_DRAW);
    }
    void* to = glMapBufferRange(GL_ARRAY_BUFFER,
                                0,
                                static_cast<GLsizeiptr>(bytes),
                                GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
    // out of memory: draws the former content
    if (to == nullptr) return;
    write(std::span<float>(static_cast<float*>(to), num_floats));
    glUnmapBuffer(GL_ARRAY_BUFFER);
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
    auto outline = gl::ShaderProgram::create("outline of a person",
                                             shaders::person_vertex(kStripCameras),
                                             shaders::outline_strip_fragment());
    if (!outline) return tl::unexpected(outline.error());
    shaders.outline = std::move(*outline);
    return shaders;
}

PersonDrawing::PersonDrawing() {
    const auto make = [](Group& group, std::size_t num_cameras) {
        group = {gl::make_vertex_array(), gl::make_buffer()};
        glBindVertexArray(group.layout.id());
        glBindBuffer(GL_ARRAY_BUFFER, group.vertices.id());
        describe_group(num_cameras);
    };
    for (std::size_t g = 0; g < groups_.size(); ++g) make(groups_[g], kCamerasPerTriangle[g]);
    make(strip_group_, kStripCameras);
    glBindVertexArray(0);
}

PersonModel PersonDrawing::set_model(PersonModel model) {
    std::swap(model_, model);
    is_blended_ = false;
    opacity_ = 1.0;
    upload_pictures();
    find_shadow();
    return model;
}

void PersonDrawing::set_pose(const Eigen::Matrix4d& world_from_site) {
    if (world_from_site == world_from_site_) return;
    world_from_site_ = world_from_site;
    find_shadow();
}

Eigen::AlignedBox3d PersonDrawing::bounds_world() const {
    if (model_.bounds_site.isEmpty()) return {};
    return model_.bounds_site.cast<double>().transformed(Eigen::Isometry3d(world_from_site_));
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

void PersonDrawing::blend(const Eigen::Vector3d& eye_world) {
    const Eigen::Vector3f eye_site =
        (world_from_site_.inverse() * eye_world.homogeneous()).head<3>().cast<float>();
    if (is_blended_ && eye_site == blended_eye_site_) return;
    blend_for_view(model_, eye_site, scratch_, blended_);
    is_blended_ = true;
    blended_eye_site_ = eye_site;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        stream(blended_.groups[g].num_vertices() * floats_per_vertex(kCamerasPerTriangle[g]),
               groups_[g].vertices,
               groups_[g].capacity_bytes,
               [&](std::span<float> to) { lay_out(model_, blended_, g, to); });
    }
    has_strip_ = false;
}

void PersonDrawing::draw(const PersonShaders& shaders,
                         const Eigen::Matrix4d& clip_from_world,
                         const Eigen::Vector3d& eye_world) {
    if (model_.triangles.empty()) return;
    blend(eye_world);
    const Eigen::Matrix4f clip_from_site = (clip_from_world * world_from_site_).cast<float>();
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D_ARRAY, pictures_.id());
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        if (blended_.groups[g].triangles.empty()) continue;
        shaders.by_group[g].use();
        shaders.by_group[g].set("clip_from_site", clip_from_site);
        shaders.by_group[g].set("pictures", 0);
        glBindVertexArray(groups_[g].layout.id());
        glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(blended_.groups[g].num_vertices()));
    }
}

// Size in the picture at the middle of the person; negative behind the eye.
double PersonDrawing::px_per_m(const Eigen::Matrix4d& clip_from_world, int height_px) const {
    const double up = clip_from_world.row(1).head<3>().norm();
    return 0.5 * height_px * up / (clip_from_world.row(3) * bounds_world().center().homogeneous());
}

void PersonDrawing::find_strip() {
    if (has_strip_) return;
    has_strip_ = true;
    strip_.find(model_, blended_eye_site_, scratch_);
    stream(strip_.vertices().size(),
           strip_group_.vertices,
           strip_group_.capacity_bytes,
           [&](std::span<float> to) { std::ranges::copy(strip_.vertices(), to.begin()); });
}

void PersonDrawing::draw_outline(const PersonShaders& shaders,
                                 const Eigen::Matrix4d& clip_from_world,
                                 const Eigen::Vector3d& eye_world,
                                 int height_px) {
    // in smaller people the strip is narrower than a pixel
    constexpr double kLeastPxPerM = 100.0;
    if (model_.triangles.empty() || !(px_per_m(clip_from_world, height_px) > kLeastPxPerM)) return;
    blend(eye_world);
    find_strip();
    if (strip_.vertices().empty()) return;
    const Eigen::Matrix4f clip_from_site = (clip_from_world * world_from_site_).cast<float>();
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D_ARRAY, pictures_.id());
    shaders.outline.use();
    shaders.outline.set("clip_from_site", clip_from_site);
    shaders.outline.set("pictures", 0);
    shaders.outline.set("opacity", static_cast<float>(opacity_));
    glBindVertexArray(strip_group_.layout.id());
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glDepthMask(GL_FALSE);
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(strip_.num_vertices()));
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
}

// Finds the shadow pixels on the CPU, once per model: about six hundred pixels from ten times as
// many triangles.
void PersonDrawing::find_shadow() {
    const Eigen::Vector3d light = light_world().cast<double>();
    Eigen::Matrix<double, 2, 4> floor_from_world = Eigen::Matrix<double, 2, 4>::Zero();
    floor_from_world.leftCols<2>().setIdentity();
    floor_from_world.col(2) = -light.head<2>() / light.z();
    constexpr double kPxPerM = Backdrop::kShadowPx / double{Backdrop::kShadowExtentM};
    Eigen::Matrix<double, 2, 4> px_from_site = kPxPerM * floor_from_world * world_from_site_;
    px_from_site.col(3).array() += 0.5 * Backdrop::kShadowPx - 0.5;
    const Eigen::Matrix<float, 2, 4> from_site = px_from_site.cast<float>();
    shadow_scratch_.corners_px.resize(model_.vertices_site.size());
    std::transform(model_.vertices_site.begin(),
                   model_.vertices_site.end(),
                   shadow_scratch_.corners_px.begin(),
                   [&](const Eigen::Vector3f& p) -> Eigen::Vector2f {
                       return from_site.leftCols<3>() * p + from_site.col(3);
                   });
    find_covered(shadow_scratch_.corners_px,
                 model_.triangles,
                 Backdrop::kShadowPx,
                 shadow_scratch_.cover,
                 shadow_scratch_.runs);
    const Eigen::RowVector4f height_from_site = world_from_site_.row(2).cast<float>();
    shadow_scratch_.heights.clear();
    for (std::size_t i = 0; i < model_.vertices_site.size(); ++i) {
        const Eigen::Vector2f& px = shadow_scratch_.corners_px[i];
        shadow_scratch_.heights.add(px.x(),
                                    px.y(),
                                    height_from_site * model_.vertices_site[i].homogeneous(),
                                    Backdrop::kShadowPx);
    }
}

}  // namespace atrium::renderer
