#include "viewer/renderer/drawing/textures.hpp"

#include <glad/gl.h>

#include <cassert>

namespace atrium::renderer {

gl::Texture upload_picture(const TexturePicture& picture, PictureUse use) {
    assert(picture.rgba.size() ==
           std::size_t{4} * static_cast<std::size_t>(picture.width * picture.height));
    const bool is_painted = use == PictureUse::kPainted;
    GLuint id = 0;
    glGenTextures(1, &id);
    gl::Texture texture(id);
    gl::bind_texture(0, texture);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D,
                 0,
                 is_painted ? GL_SRGB8_ALPHA8 : GL_RGBA8,
                 picture.width,
                 picture.height,
                 0,
                 GL_RGBA,
                 GL_UNSIGNED_BYTE,
                 picture.rgba.data());
    glGenerateMipmap(GL_TEXTURE_2D);
    const GLint wrap = is_painted ? GL_REPEAT : GL_CLAMP_TO_EDGE;
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wrap);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wrap);
    return texture;
}

void Textures::set(const std::string& name, const TexturePicture& picture) {
    textures_.insert_or_assign(name, upload_picture(picture, PictureUse::kPainted));
}

bool Textures::bind(const std::string& name, int unit) const {
    const auto found = textures_.find(name);
    if (found == textures_.end()) return false;
    gl::bind_texture(unit, found->second);
    return true;
}

}  // namespace atrium::renderer
