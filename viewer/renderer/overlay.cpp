#include "viewer/renderer/overlay.hpp"

#include "viewer/renderer/drawing/shaders.hpp"
#include "viewer/renderer/drawing/textures.hpp"

#include <glad/gl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace atrium::renderer {
namespace {

constexpr double kLinePerPx = 720.0;  // height of a picture whose lines are one pixel wide
constexpr double kNearestM = 0.1;     // distance from the eye; nearer labels would fill the picture

double depth_of(const EyeView& eye, const Eigen::Vector3d& p_world) {
    return -(eye.view_from_world.row(2).head<3>().dot(p_world) + eye.view_from_world(2, 3));
}

// Whether the label's picture has the size that it gets in the eye's picture.
bool is_drawn_pixel_by_pixel(const Label& label, const EyeView& eye) {
    return std::lround(label.height * eye.part_px.height) == label.picture->height;
}

// Moves the middle of a label by less than a pixel, so that its pixels are those of the eye's
// picture. A filter between them would blur the letters.
void snap_to_pixels(const Label& label,
                    const EyeView& eye,
                    double depth_m,
                    Eigen::Vector3d& middle) {
    const std::array<int, 2> size_px{eye.part_px.width, eye.part_px.height};
    const std::array<int, 2> label_px{label.picture->width, label.picture->height};
    for (const int axis : {0, 1}) {
        const auto i = static_cast<std::size_t>(axis);
        const double ndc = eye.clip_from_view.row(axis).head<3>().dot(middle) / depth_m;
        const double low_px = 0.5 * (ndc + 1.0) * size_px[i] - 0.5 * label_px[i];
        const double px_m = 2.0 * depth_m / (size_px[i] * eye.clip_from_view(axis, axis));
        middle[axis] += (std::round(low_px) - low_px) * px_m;
    }
}

constexpr const char* kLabelVertex = R"(#version 330 core
layout(location = 0) in vec2 corner;
uniform mat4 clip_from_view;
uniform vec3 middle;
uniform vec2 half_size;
out vec2 at;
void main() {
    at = vec2(0.5 + 0.5 * corner.x, 0.5 - 0.5 * corner.y);
    gl_Position = clip_from_view * vec4(middle + vec3(corner * half_size, 0.0), 1.0);
}
)";

constexpr const char* kLabelFragment = R"(#version 330 core
in vec2 at;
uniform sampler2D picture;
uniform float opacity;
out vec4 fragment;
void main() { fragment = opacity * texture(picture, at); }
)";

constexpr const char* kLineFragment = R"(#version 330 core
in vec3 line_colour;
uniform float opacity;
out vec4 fragment;
void main() { fragment = vec4(line_colour, opacity); }
)";

}  // namespace

Expected<Overlay> Overlay::create() {
    auto label = gl::ShaderProgram::create("label", kLabelVertex, kLabelFragment);
    if (!label) return tl::unexpected(label.error());
    auto line = gl::ShaderProgram::create(
        "line", shaders::passing_vertex("vec3", "line_colour"), kLineFragment);
    if (!line) return tl::unexpected(line.error());
    Overlay made;
    made.label_shader_ = std::move(*label);
    made.line_shader_ = std::move(*line);
    made.line_layout_ = gl::make_vertex_array();
    made.line_ends_ = gl::make_buffer();
    made.triangle_layout_ = gl::make_vertex_array();
    made.triangle_corners_ = gl::make_buffer();
    return made;
}

void Overlay::set_labels(std::vector<Label> labels) {
    labels_ = std::move(labels);
    std::map<std::shared_ptr<const TexturePicture>, gl::Texture> used;
    for (const Label& label : labels_) {
        if (used.contains(label.picture)) continue;
        const auto found = pictures_.find(label.picture);
        // labels may appear at half size or less: mipmaps keep them smooth
        used[label.picture] = found != pictures_.end()
                                  ? std::move(found->second)
                                  : upload_picture(*label.picture, PictureUse::kLabel);
    }
    pictures_ = std::move(used);
}

void Overlay::set_lines(std::span<const Line> lines) {
    num_lines_ = lines.size();
    if (lines.empty()) return;
    glBindVertexArray(line_layout_.id());
    gl::upload(line_ends_, GL_ARRAY_BUFFER, lines, GL_STREAM_DRAW);
    gl::float_attribute(0, 3, sizeof(Line::End), 0);
    gl::float_attribute(1, 3, sizeof(Line::End), sizeof(Eigen::Vector3f));
    glBindVertexArray(0);
}

void Overlay::set_triangles(std::span<const Triangle> triangles) {
    num_triangles_ = triangles.size();
    if (triangles.empty()) return;
    static_assert(sizeof(Triangle) == 3 * sizeof(Line::End));
    glBindVertexArray(triangle_layout_.id());
    gl::upload(triangle_corners_, GL_ARRAY_BUFFER, triangles, GL_STREAM_DRAW);
    gl::float_attribute(0, 3, sizeof(Line::End), 0);
    gl::float_attribute(1, 3, sizeof(Line::End), sizeof(Eigen::Vector3f));
    glBindVertexArray(0);
}

void Overlay::draw_triangles(const EyeView& eye) const {
    if (num_triangles_ == 0) return;
    glDisable(GL_DEPTH_TEST);
    line_shader_.use();
    line_shader_.set("clip_from_model", Eigen::Matrix4f(eye.clip_from_world().cast<float>()));
    line_shader_.set("opacity", 1.0f);
    glBindVertexArray(triangle_layout_.id());
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(3 * num_triangles_));
    glEnable(GL_DEPTH_TEST);
}

void Overlay::draw_label(const Label& label, const EyeView& eye) const {
    const double depth_m = depth_of(eye, label.at_world);
    if (depth_m < kNearestM || label.opacity <= 0.0) return;
    // in view space, so the label stretches with the picture of the display
    const double half_height_m = label.height * depth_m / eye.clip_from_view(1, 1);
    const double aspect = static_cast<double>(label.picture->width) / label.picture->height;
    Eigen::Vector3d middle = (eye.view_from_world * label.at_world.homogeneous()).head<3>();
    middle.y() += (1.0 + 2.0 * label.raised) * half_height_m;
    if (is_drawn_pixel_by_pixel(label, eye)) snap_to_pixels(label, eye, depth_m, middle);
    label_shader_.set("clip_from_view", Eigen::Matrix4f(eye.clip_from_view.cast<float>()));
    label_shader_.set("middle", Eigen::Vector3f(middle.cast<float>()));
    label_shader_.set("half_size",
                      Eigen::Vector2f(static_cast<float>(aspect * half_height_m),
                                      static_cast<float>(half_height_m)));
    label_shader_.set("opacity", static_cast<float>(label.opacity));
    gl::bind_texture(0, pictures_.at(label.picture));
    square_.draw();
}

void set_line_width(const EyeView& eye) {
    std::array<float, 2> range{1.0f, 1.0f};
    glGetFloatv(GL_ALIASED_LINE_WIDTH_RANGE, range.data());
    const double width_px = std::max(1.0, std::round(eye.part_px.height / kLinePerPx));
    glLineWidth(std::min(static_cast<float>(width_px), range[1]));
}

void Overlay::draw_lines(const EyeView& eye) const {
    if (num_lines_ == 0) return;
    constexpr float kHiddenOpacity = 0.3f;
    line_shader_.use();
    line_shader_.set("clip_from_model", Eigen::Matrix4f(eye.clip_from_world().cast<float>()));
    glBindVertexArray(line_layout_.id());
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    for (const bool is_hidden : {true, false}) {
        // does not write depths, so lines do not hide each other
        glDepthMask(GL_FALSE);
        glDepthFunc(is_hidden ? GL_GREATER : GL_LEQUAL);
        line_shader_.set("opacity", is_hidden ? kHiddenOpacity : 1.0f);
        glDrawArrays(GL_LINES, 0, static_cast<GLsizei>(2 * num_lines_));
    }
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_LEQUAL);
    glDisable(GL_BLEND);
}

void Overlay::draw_labels(const EyeView& eye) const {
    if (labels_.empty()) return;
    // back to front
    std::vector<const Label*> order;
    for (const Label& label : labels_) order.push_back(&label);
    std::sort(order.begin(), order.end(), [&](const Label* a, const Label* b) {
        return depth_of(eye, a->at_world) > depth_of(eye, b->at_world);
    });
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    label_shader_.use();
    label_shader_.set("picture", 0);
    for (const Label* label : order) draw_label(*label, eye);
    glDisable(GL_BLEND);
    glEnable(GL_DEPTH_TEST);
}

}  // namespace atrium::renderer
