#pragma once

#include "core/gl/resources.hpp"
#include "viewer/renderer/drawing/object_look.hpp"

#include <cstdint>
#include <map>
#include <string>

namespace atrium::renderer {

/// How shaders use a picture.
enum class PictureUse : std::uint8_t {
    /// Painted on objects. Repeats. sRGB: sampling, filtering and mipmaps work in linear light, as
    /// the lighting does.
    kPainted,
    /// Shown as it is, up to its edge.
    kLabel
};

/// Uploads a picture with mipmaps. Width and height are at least 1.
gl::Texture upload_picture(const TexturePicture& picture, PictureUse use);

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
