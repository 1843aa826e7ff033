#include "viewer/renderer/object/textures.hpp"

#include <glad/gl.h>

#include <cassert>

namespace atrium::renderer {

void Textures::set(const std::string& name, const TexturePicture& picture) {
    assert(picture.rgba.size() ==
           std::size_t{4} * static_cast<std::size_t>(picture.width * picture.height));
    GLuint id = 0;
    glGenTextures(1, &id);
    textures_.insert_or_assign(name, gl::Texture(id));
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, id);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    // sRGB format: sampling, filtering and mipmaps work in linear light, as the lighting does
    glTexImage2D(GL_TEXTURE_2D,
                 0,
                 GL_SRGB8_ALPHA8,
                 picture.width,
                 picture.height,
                 0,
                 GL_RGBA,
                 GL_UNSIGNED_BYTE,
                 picture.rgba.data());
    glGenerateMipmap(GL_TEXTURE_2D);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_REPEAT);
}

bool Textures::bind(const std::string& name, int unit) const {
    const auto found = textures_.find(name);
    if (found == textures_.end()) return false;
    gl::bind_texture(unit, found->second);
    return true;
}

}  // namespace atrium::renderer
