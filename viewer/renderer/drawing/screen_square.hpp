#pragma once

#include "core/gl/resources.hpp"

namespace atrium::renderer {

/// A square from (-1, -1) to (1, 1) as attribute 0 of two components. Covers the whole picture, or
/// a floor after scaling by a shader.
class ScreenSquare {
public:
    ScreenSquare();
    /// Draws with the bound shader.
    void draw() const;

private:
    gl::VertexArray layout_;
    gl::Buffer corners_;
};

}  // namespace atrium::renderer
