#include "viewer/renderer/person/silhouette_drawing.hpp"

#include "viewer/renderer/drawing/shaders.hpp"

#include <glad/gl.h>

#include <array>
#include <optional>
#include <utility>

namespace atrium::renderer {
namespace {

const Eigen::Vector3f kOutlineColour(0.1f, 0.75f, 1.0f);
// per axis: a wide lens bends by less than a pixel within one cell
constexpr int kCellsOfALens = 12;

// The outline is one screen pixel wide around the person, at any size of the person.
constexpr const char* kSilhouetteFragment = R"(#version 330 core
in vec2 at;
uniform sampler2DArray pictures;
uniform float layer;
uniform float opacity;
uniform vec3 outline;
out vec4 fragment;
const float kInside = 0.1;  // least alpha of texels inside the mask; at its edge alpha is lower
void main() {
    vec4 here = texture(pictures, vec3(at, layer));
    vec2 right = dFdx(at);
    vec2 up = dFdy(at);
    vec2 beside = max(vec2(texture(pictures, vec3(at - right, layer)).a,
                           texture(pictures, vec3(at - up, layer)).a),
                      vec2(texture(pictures, vec3(at + right, layer)).a,
                           texture(pictures, vec3(at + up, layer)).a));
    vec4 colour = vec4(outline, 0.12);
    if (here.a >= kInside)
        colour = vec4(here.rgb / here.a, 0.95);
    else if (max(beside.x, beside.y) >= kInside)
        colour.a = 1.0;
    fragment = vec4(colour.rgb * colour.a, colour.a) * opacity;
}
)";

}  // namespace

void append_silhouette(const PersonModel::Camera& camera,
                       double distance_m,
                       std::vector<SilhouetteCorner>& corners) {
    const geometry::RigidTransform site_from_camera = camera.camera_from_site.inverse();
    const int num_cells = camera.intrinsics.has_distortion() ? kCellsOfALens : 1;
    const auto knot = [&](int column, int row) -> std::optional<SilhouetteCorner> {
        const Eigen::Array2d share = Eigen::Array2d(column, row) / num_cells;
        const image::PixelRect& crop = camera.crop_px;
        // the crop extends half a pixel beyond the centres of its outer pixels
        const Eigen::Vector2d px =
            Eigen::Array2d(crop.x, crop.y) - 0.5 + share * Eigen::Array2d(crop.width, crop.height);
        const auto straight = camera.intrinsics.undistort(px);
        if (!straight) return std::nullopt;
        const Eigen::Vector3d p_camera = distance_m * camera.intrinsics.ray_camera(*straight);
        const Eigen::Array2f st =
            camera.low_st.array() + share.cast<float>() * (camera.high_st - camera.low_st).array();
        return SilhouetteCorner{(site_from_camera * p_camera).cast<float>(), st};
    };
    for (int row = 0; row < num_cells; ++row) {
        for (int column = 0; column < num_cells; ++column) {
            const std::array four{knot(column, row),
                                  knot(column + 1, row),
                                  knot(column, row + 1),
                                  knot(column + 1, row + 1)};
            if (!four[0] || !four[1] || !four[2] || !four[3]) continue;
            for (const std::size_t i : {0U, 1U, 2U, 2U, 1U, 3U}) corners.push_back(*four[i]);
        }
    }
}

Expected<SilhouetteDrawing> SilhouetteDrawing::create() {
    auto shader = gl::ShaderProgram::create(
        "silhouette", shaders::passing_vertex("vec2", "at"), kSilhouetteFragment);
    if (!shader) return tl::unexpected(shader.error());
    SilhouetteDrawing made;
    made.shader_ = std::move(*shader);
    made.layout_ = gl::make_vertex_array();
    made.buffer_ = gl::make_buffer();
    return made;
}

void SilhouetteDrawing::draw(const std::map<std::string, PersonDrawing>& people,
                             const Eigen::Matrix4d& clip_from_world,
                             double distance_m) {
    if (distance_m <= 0.0) return;
    for (const auto& [site, person] : people) draw(person, clip_from_world, distance_m);
}

void SilhouetteDrawing::draw(const PersonDrawing& person,
                             const Eigen::Matrix4d& clip_from_world,
                             double distance_m) {
    if (!person.pictures() || person.model().triangles.empty()) return;
    shader_.use();
    shader_.set("clip_from_model",
                Eigen::Matrix4f((clip_from_world * person.world_from_site()).cast<float>()));
    shader_.set("pictures", 0);
    shader_.set("outline", kOutlineColour);
    shader_.set("opacity", static_cast<float>(person.opacity()));
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D_ARRAY, person.pictures().id());
    glBindVertexArray(layout_.id());
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glDepthMask(GL_FALSE);
    float layer = 0.0f;
    for (const PersonModel::Camera& camera : person.model().cameras) {
        corners_.clear();
        append_silhouette(camera, distance_m, corners_);
        gl::upload(
            buffer_, GL_ARRAY_BUFFER, std::span<const SilhouetteCorner>(corners_), GL_STREAM_DRAW);
        gl::float_attribute(0, 3, sizeof(SilhouetteCorner), 0);
        gl::float_attribute(1, 2, sizeof(SilhouetteCorner), sizeof(Eigen::Vector3f));
        shader_.set("layer", layer++);
        glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners_.size()));
    }
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
}

}  // namespace atrium::renderer
