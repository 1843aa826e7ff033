#pragma once

#include "core/base/expected.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace atrium::gl {

/// Owns one GL object name. Create, use and destroy everything in this file while its context is
/// current. Enumerators such as GL_STATIC_DRAW come from <glad/gl.h>, which only sources include.
template <void (*kDelete)(unsigned)>
class Owned {
public:
    Owned() = default;
    explicit Owned(unsigned id) : id_(id) {}
    Owned(Owned&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
    Owned& operator=(Owned&& other) noexcept {
        std::swap(id_, other.id_);
        return *this;
    }
    ~Owned() {
        if (id_ != 0) kDelete(id_);
    }
    unsigned id() const { return id_; }
    explicit operator bool() const { return id_ != 0; }

private:
    unsigned id_ = 0;  // 0: none
};

void delete_buffer(unsigned id);
void delete_vertex_array(unsigned id);
void delete_texture(unsigned id);
void delete_framebuffer(unsigned id);

using Buffer = Owned<&delete_buffer>;
using VertexArray = Owned<&delete_vertex_array>;
using Texture = Owned<&delete_texture>;
using FramebufferName = Owned<&delete_framebuffer>;

Buffer make_buffer();
VertexArray make_vertex_array();

/// Replaces the contents of `buffer`, which stays bound to `target` (such as GL_ARRAY_BUFFER).
/// `usage` is for example GL_STATIC_DRAW.
void upload(const Buffer& buffer,
            unsigned target,
            std::span<const std::byte> bytes,
            unsigned usage);

template <typename T>
void upload(const Buffer& buffer, unsigned target, std::span<const T> items, unsigned usage) {
    upload(buffer, target, std::as_bytes(items), usage);
}

/// Connects float attribute `index` of the bound vertex array to the bound GL_ARRAY_BUFFER.
void float_attribute(unsigned index,
                     int num_components,
                     std::size_t stride_bytes,
                     std::size_t offset_bytes);

/// Pixel formats of textures and framebuffers.
enum class PixelFormat : std::uint8_t { kR8, kRg8, kRgb8, kRgba8, kR32F, kDepth24 };

struct TextureOptions {
    PixelFormat format = PixelFormat::kRgba8;
    bool linear = true;   // filter: linear or nearest
    bool repeat = false;  // wrap: repeat or clamp to the edge
};

/// Creates a 2D texture without mipmaps; its contents are undefined.
Texture make_texture(int width, int height, const TextureOptions& options = {});

/// Writes tightly packed pixels (`options.format` of `make_texture`, bytes or floats) into the
/// rectangle at (x, y).
void upload_pixels(const Texture& texture,
                   PixelFormat format,
                   int x,
                   int y,
                   int width,
                   int height,
                   const void* pixels);

void bind_texture(int unit, const Texture& texture);

/// A framebuffer with colour and depth textures of the same size. Without colour: depth only, for
/// shadows.
struct Framebuffer {
    FramebufferName name;
    Texture colour;
    Texture depth;
    int width = 0;
    int height = 0;

    /// Binds it for drawing and reading, and sets the viewport to its full size.
    void bind() const;
};

/// Creates a framebuffer. Fails with kInternal if the driver reports it as incomplete.
Expected<Framebuffer> make_framebuffer(int width,
                                       int height,
                                       PixelFormat colour_format = PixelFormat::kRgba8);

/// Reads `width` by `height` colour pixels of the bound framebuffer into `out`, bottom row first as
/// in GL, without padding. `out` holds at least 4 * width * height bytes.
void read_rgba(int width, int height, std::span<std::uint8_t> out);

}  // namespace atrium::gl
