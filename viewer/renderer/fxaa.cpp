#include "viewer/renderer/fxaa.hpp"

#include <Eigen/Core>
#include <glad/gl.h>

#include <utility>

namespace atrium::renderer {
namespace {

constexpr const char* kScreenVertex = R"(#version 330 core
layout(location = 0) in vec2 corner;
out vec2 at;
void main() {
    at = corner * 0.5 + 0.5;
    gl_Position = vec4(corner, 0.0, 1.0);
}
)";

// After: Lottes. FXAA. 2009. In its shortest form: where the luma of the four diagonal neighbours
// differs, average along the edge.
constexpr const char* kFxaaFragment = R"(#version 330 core
in vec2 at;
uniform sampler2D picture;
uniform vec2 pixel;
out vec4 fragment;
void main() {
    const vec3 luma = vec3(0.299, 0.587, 0.114);
    vec3 centre = texture(picture, at).rgb;
    float nw = dot(texture(picture, at + vec2(-0.5, 0.5) * pixel).rgb, luma);
    float ne = dot(texture(picture, at + vec2(0.5, 0.5) * pixel).rgb, luma);
    float sw = dot(texture(picture, at + vec2(-0.5, -0.5) * pixel).rgb, luma);
    float se = dot(texture(picture, at + vec2(0.5, -0.5) * pixel).rgb, luma);
    float low = min(min(nw, ne), min(sw, se));
    float high = max(max(nw, ne), max(sw, se));
    if (high - low < max(0.03, 0.12 * high)) {
        fragment = vec4(centre, 1.0);
        return;
    }
    vec2 along = vec2(sw + se - nw - ne, nw + sw - ne - se);
    along = vec2(nw + ne - sw - se, nw + sw - ne - se) * vec2(-1.0, 1.0);
    float least = min(abs(along.x), abs(along.y)) + 0.02;
    along = clamp(along / least, -4.0, 4.0) * pixel;
    vec3 near = 0.5 * (texture(picture, at + along * (1.0 / 3.0 - 0.5)).rgb
                     + texture(picture, at + along * (2.0 / 3.0 - 0.5)).rgb);
    fragment = vec4(near, 1.0);
}
)";

}  // namespace

Expected<Fxaa> Fxaa::create() {
    auto shader = gl::ShaderProgram::create("smooth", kScreenVertex, kFxaaFragment);
    if (!shader) return tl::unexpected(shader.error());
    Fxaa fxaa;
    fxaa.shader_ = std::move(*shader);
    return fxaa;
}

Expected<void> Fxaa::resize(int width, int height) {
    auto framebuffer = gl::make_framebuffer(width, height);
    if (!framebuffer) return tl::unexpected(framebuffer.error());
    smoothed_ = std::move(*framebuffer);
    return {};
}

void Fxaa::draw(const gl::Framebuffer& from) {
    smoothed_.bind();
    glDisable(GL_DEPTH_TEST);
    shader_.use();
    gl::bind_texture(0, from.colour);
    shader_.set("picture", 0);
    shader_.set("pixel",
                Eigen::Vector2f(1.0f / static_cast<float>(from.width),
                                1.0f / static_cast<float>(from.height)));
    square_.draw();
}

}  // namespace atrium::renderer
