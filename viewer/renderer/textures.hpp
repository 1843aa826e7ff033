#pragma once

#include "core/gl/resources.hpp"
#include "viewer/renderer/object_look.hpp"

#include <map>
#include <string>

namespace atrium::renderer {

/// The pictures that lie on things, in GL's memory, by name.
class Textures {
public:
    /// Replaces the one of that name. Its width and height are at least 1.
    void set(const std::string& name, const TexturePicture& picture);

    void remove(const std::string& name) { textures_.erase(name); }

    /// Binds the one of that name to a unit; false where there is none.
    bool bind(const std::string& name, int unit) const;

private:
    std::map<std::string, gl::Texture> textures_;
};

}  // namespace atrium::renderer
