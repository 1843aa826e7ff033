#include "viewer/renderer/object/object_shaders.hpp"

#include "viewer/renderer/backdrop/backdrop.hpp"

#include <utility>

namespace atrium::renderer {

Expected<ObjectShaders> ObjectShaders::create(const char* name, const char* vertex) {
    ObjectShaders made;
    for (std::size_t i = 0; i < shaders::kNumSurfaces; ++i) {
        auto program = gl::ShaderProgram::create(
            name, vertex, shaders::object_fragment(static_cast<shaders::Surface>(i)));
        if (!program) return tl::unexpected(program.error());
        made.by_surface_[i] = std::move(*program);
    }
    return made;
}

void ObjectShaders::set_view(const View& view) const {
    for (const gl::ShaderProgram& shader : by_surface_) {
        shader.use();
        shader.set("clip_from_world", Eigen::Matrix4f(view.clip_from_world.cast<float>()));
        shader.set("light", light_world());
        shader.set("eye", Eigen::Vector3f(view.eye_world.cast<float>()));
        shader.set("picture", 0);
    }
}

}  // namespace atrium::renderer
