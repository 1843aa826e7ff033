#include "viewer/renderer/fxaa.hpp"

#include "viewer/renderer/shaders.hpp"

#include <Eigen/Core>
#include <glad/gl.h>

#include <utility>

namespace atrium::renderer {

Expected<Fxaa> Fxaa::create() {
    auto shader =
        gl::ShaderProgram::create("smooth", shaders::kScreenVertex, shaders::kFxaaFragment);
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
