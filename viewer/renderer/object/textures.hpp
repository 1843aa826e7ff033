#pragma once

#include "core/gl/resources.hpp"
#include "viewer/renderer/object/object_look.hpp"

#include <map>
#include <string>

namespace atrium::renderer {

/// Textures of objects in GL memory, by name.
class Textures {
public:
    /// Sets or replaces a texture. Width and height are at least 1.
    void set(const std::string& name, const TexturePicture& picture);

    void remove(const std::string& name) { textures_.erase(name); }

    /// Binds a texture to a unit. Returns false if it does not exist.
    bool bind(const std::string& name, int unit) const;

private:
    std::map<std::string, gl::Texture> textures_;
};

}  // namespace atrium::renderer
