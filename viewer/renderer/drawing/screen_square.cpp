#include "viewer/renderer/drawing/screen_square.hpp"

#include <glad/gl.h>

#include <array>

namespace atrium::renderer {

ScreenSquare::ScreenSquare() : layout_(gl::make_vertex_array()), corners_(gl::make_buffer()) {
    constexpr std::array<float, 8> kCorners = {-1.0f, -1.0f, 1.0f, -1.0f, -1.0f, 1.0f, 1.0f, 1.0f};
    glBindVertexArray(layout_.id());
    gl::upload(corners_, GL_ARRAY_BUFFER, std::span<const float>(kCorners), GL_STATIC_DRAW);
    gl::float_attribute(0, 2, 2 * sizeof(float), 0);
    glBindVertexArray(0);
}

void ScreenSquare::draw() const {
    glBindVertexArray(layout_.id());
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

}  // namespace atrium::renderer
