#pragma once

#include "core/base/expected.hpp"
#include "core/codec/mask_codec.hpp"
#include "core/image/image.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace atrium::codec {

/// Largest coded colour picture [bytes]; decoders reject more. Expected ones are a fraction of it.
constexpr std::size_t kMaxColourBytes = std::size_t{1} << 20;

/// The subject as one camera sees it. All four planes have half the width and height of crop_px or,
/// if the site is configured so, its full size.
struct TextureCrop {
    image::PixelRect crop_px;  // in the delivered picture, full-resolution pixels; all even
    image::Plane y;            // full-range BT.601, as in image::YuvImage
    image::Plane u;
    image::Plane v;
    image::Mask mask;  // 255 where the picture shows the subject

    int width() const { return y.width; }
    int height() const { return y.height; }
};

struct CodedTexture {
    /// Baseline JPEG, 4:4:4, full-range BT.601, of the mask's size or half its width and height.
    std::vector<std::uint8_t> colour;
    std::vector<std::uint8_t> mask;  // see mask_codec.hpp
};

/// A texture ready for the GPU: rows from the top, R, G, B, A; alpha is 255 where the picture shows
/// the subject, else 0.
struct DecodedTexture {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> rgba;
};

/// Encodes textures. Reuses its memory and the JPEG library's state; use one per thread.
class TextureEncoder {
public:
    TextureEncoder();
    ~TextureEncoder();
    TextureEncoder(TextureEncoder&&) noexcept;
    TextureEncoder& operator=(TextureEncoder&&) noexcept;

    /// Encodes colours and mask, not crop_px. `quality` is 1 to 100 (see quantisation_step). Does
    /// not convert colours. Fails with kInvalidData if the planes are empty, differ in size or
    /// exceed the limits of TextureDecoder.
    Expected<void> encode(const TextureCrop& crop, int quality, CodedTexture& out);
    /// Like `encode`, with a `divisor` of 1 or 2. With 2 the colours have half the width and height
    /// of the mask, rounded up, each the mean of up to four. The mask is unchanged.
    Expected<void> encode(const TextureCrop& crop, int quality, int divisor, CodedTexture& out);

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Decodes textures. Reuses its memory and the JPEG library's state; use one per thread.
class TextureDecoder {
public:
    TextureDecoder();
    ~TextureDecoder();
    TextureDecoder(TextureDecoder&&) noexcept;
    TextureDecoder& operator=(TextureDecoder&&) noexcept;

    /// Decodes the result of TextureEncoder::encode; `out` has the size of the mask for every
    /// divisor. Safe for untrusted input: fails with kInvalidData if a part is damaged, too large
    /// or not of the encoder's kind, or if the sizes of colours and mask do not fit (divisor 1 or
    /// 2); `out` is then undefined. Damage that leaves a valid picture only shows wrong pixels.
    Expected<void> decode(std::span<const std::uint8_t> colour,
                          std::span<const std::uint8_t> mask,
                          DecodedTexture& out);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace atrium::codec
