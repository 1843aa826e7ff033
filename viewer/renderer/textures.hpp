#pragma once

#include "core/gl/resources.hpp"
#include "core/gl/shader_program.hpp"
#include "viewer/renderer/object_look.hpp"

#include <map>
#include <string>

namespace atrium::renderer {

/// The pictures that lie on things, in GL's memory, by name.
class Textures {
public:
    /// Replaces the one of that name. Its width and height are at least 1.
    void set(const std::string& name, const TexturePicture& picture);

    /// Binds the one of that name to a unit for the shader in use, whose "picture" and "textured"
    /// it sets; where there is none, the shader is told so.
    void use(const std::string& name, const gl::ShaderProgram& shader, int unit) const;

private:
    std::map<std::string, gl::Texture> textures_;
};

}  // namespace atrium::renderer
