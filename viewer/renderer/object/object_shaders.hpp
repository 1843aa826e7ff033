#pragma once

#include "core/base/expected.hpp"
#include "core/gl/shader_program.hpp"
#include "viewer/renderer/drawing/shaders.hpp"
#include "viewer/renderer/drawing/view_camera.hpp"

#include <array>

namespace atrium::renderer {

/// Shaders of lit objects, one per kind of surface.
class ObjectShaders {
public:
    /// `vertex` is kObjectVertex or kSoftVertex.
    static Expected<ObjectShaders> create(const char* name, const char* vertex);

    /// Sets the view of all shaders.
    void set_view(const View& view) const;
    const gl::ShaderProgram& of(shaders::Surface surface) const {
        return by_surface_[static_cast<std::size_t>(surface)];
    }

private:
    std::array<gl::ShaderProgram, shaders::kNumSurfaces> by_surface_;
};

}  // namespace atrium::renderer
