#pragma once

#include "core/gl/resources.hpp"

namespace atrium::renderer {

/// A square from (-1, -1) to (1, 1), as attribute 0 of two components: the whole picture, or a
/// floor once a shader has stretched it.
class ScreenSquare {
public:
    ScreenSquare();
    /// With the shader in use.
    void draw() const;

private:
    gl::VertexArray layout_;
    gl::Buffer corners_;
};

}  // namespace atrium::renderer
