#pragma once

#include "core/base/expected.hpp"
#include "core/gl/resources.hpp"
#include "core/gl/shader_program.hpp"
#include "viewer/renderer/drawing/screen_square.hpp"

namespace atrium::renderer {

/// Anti-aliases a finished picture into another framebuffer (FXAA).
class Fxaa {
public:
    static Expected<Fxaa> create();
    Expected<void> resize(int width, int height);
    void draw(const gl::Framebuffer& from);
    const gl::Framebuffer& picture() const { return smoothed_; }

private:
    gl::ShaderProgram shader_;
    gl::Framebuffer smoothed_;
    ScreenSquare square_;
};

}  // namespace atrium::renderer
