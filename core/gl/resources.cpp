#include "core/gl/resources.hpp"

#include <glad/gl.h>

#include <cassert>

namespace atrium::gl {
namespace {

struct GlFormat {
    GLint internal;
    GLenum layout;
    GLenum type;
};

GlFormat gl_format(PixelFormat format) {
    switch (format) {
        case PixelFormat::kR8:
            return {GL_R8, GL_RED, GL_UNSIGNED_BYTE};
        case PixelFormat::kRg8:
            return {GL_RG8, GL_RG, GL_UNSIGNED_BYTE};
        case PixelFormat::kRgb8:
            return {GL_RGB8, GL_RGB, GL_UNSIGNED_BYTE};
        case PixelFormat::kRgba8:
            return {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE};
        case PixelFormat::kR32F:
            return {GL_R32F, GL_RED, GL_FLOAT};
        case PixelFormat::kDepth24:
            return {GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT};
    }
    return {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE};
}

Expected<void> check_bound_framebuffer(int width, int height) {
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE) return {};
    return make_error(ErrorKind::kInternal,
                      "OpenGL: cannot make a framebuffer of " + std::to_string(width) + "x" +
                          std::to_string(height) + " pixels");
}

FramebufferName make_framebuffer_name() {
    GLuint id = 0;
    glGenFramebuffers(1, &id);
    return FramebufferName(id);
}

}  // namespace

void delete_buffer(unsigned id) { glDeleteBuffers(1, &id); }
void delete_vertex_array(unsigned id) { glDeleteVertexArrays(1, &id); }
void delete_texture(unsigned id) { glDeleteTextures(1, &id); }
void delete_framebuffer(unsigned id) { glDeleteFramebuffers(1, &id); }

Buffer make_buffer() {
    GLuint id = 0;
    glGenBuffers(1, &id);
    return Buffer(id);
}

VertexArray make_vertex_array() {
    GLuint id = 0;
    glGenVertexArrays(1, &id);
    return VertexArray(id);
}

void upload(const Buffer& buffer,
            unsigned target,
            std::span<const std::byte> bytes,
            unsigned usage) {
    glBindBuffer(target, buffer.id());
    glBufferData(target, static_cast<GLsizeiptr>(bytes.size()), bytes.data(), usage);
}

void float_attribute(unsigned index,
                     int num_components,
                     std::size_t stride_bytes,
                     std::size_t offset_bytes) {
    glEnableVertexAttribArray(index);
    glVertexAttribPointer(index,
                          num_components,
                          GL_FLOAT,
                          GL_FALSE,
                          static_cast<GLsizei>(stride_bytes),
                          reinterpret_cast<const void*>(offset_bytes));
}

Texture make_texture(int width, int height, const TextureOptions& options) {
    assert(width > 0 && height > 0);
    GLuint id = 0;
    glGenTextures(1, &id);
    Texture texture(id);
    const GlFormat format = gl_format(options.format);
    glBindTexture(GL_TEXTURE_2D, id);
    glTexImage2D(
        GL_TEXTURE_2D, 0, format.internal, width, height, 0, format.layout, format.type, nullptr);
    const GLint filter = options.linear ? GL_LINEAR : GL_NEAREST;
    const GLint wrap = options.repeat ? GL_REPEAT : GL_CLAMP_TO_EDGE;
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wrap);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wrap);
    return texture;
}

void upload_pixels(const Texture& texture,
                   PixelFormat format,
                   int x,
                   int y,
                   int width,
                   int height,
                   const void* pixels) {
    const GlFormat gl = gl_format(format);
    glBindTexture(GL_TEXTURE_2D, texture.id());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexSubImage2D(GL_TEXTURE_2D, 0, x, y, width, height, gl.layout, gl.type, pixels);
}

void bind_texture(int unit, const Texture& texture) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
    glBindTexture(GL_TEXTURE_2D, texture.id());
}

void Framebuffer::bind() const {
    glBindFramebuffer(GL_FRAMEBUFFER, name.id());
    glViewport(0, 0, width, height);
}

Expected<Framebuffer> make_framebuffer(int width, int height, PixelFormat colour_format) {
    Framebuffer result{
        .name = make_framebuffer_name(),
        .colour = make_texture(width, height, {.format = colour_format}),
        .depth = make_texture(width, height, {.format = PixelFormat::kDepth24, .linear = false}),
        .width = width,
        .height = height};
    result.bind();
    glFramebufferTexture2D(
        GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, result.colour.id(), 0);
    glFramebufferTexture2D(
        GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, result.depth.id(), 0);
    if (auto complete = check_bound_framebuffer(width, height); !complete)
        return tl::unexpected(complete.error());
    return result;
}

void read_rgba(int width, int height, std::span<std::uint8_t> out) {
    assert(out.size() >= static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, out.data());
}

}  // namespace atrium::gl
