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

/// Largest coded colour picture that is looked at; no sample on the bus is larger than a part of
/// it.
constexpr std::size_t kMaxColourBytes = std::size_t{1} << 20;

/// The subject as one camera sees it, at half resolution or, where a site says so, at full: all
/// four planes are as large as crop_px, or half as wide and high.
struct TextureCrop {
    image::PixelRect
        crop_px;     // in the delivered picture, full-resolution pixels; all four numbers are even
    image::Plane y;  // full-range BT.601, as in image::YuvImage
    image::Plane u;
    image::Plane v;
    image::Mask mask;  // 255 where the picture shows the subject

    int width() const { return y.width; }
    int height() const { return y.height; }
};

struct CodedTexture {
    std::vector<std::uint8_t>
        colour;  // baseline JPEG, 4:4:4, full-range BT.601; as large as the mask, or half
    std::vector<std::uint8_t> mask;  // see mask_codec.hpp
};

/// Ready for the GPU: rows from the top, R, G, B, A; alpha is 255 where the picture shows the
/// subject, else 0.
struct DecodedTexture {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> rgba;
};

/// Holds the JPEG library's state and memory that is reused; one per thread.
class TextureEncoder {
public:
    TextureEncoder();
    ~TextureEncoder();
    TextureEncoder(TextureEncoder&&) noexcept;
    TextureEncoder& operator=(TextureEncoder&&) noexcept;

    /// Codes colours and mask (not crop_px); `quality` is 1 to 100 (see quantisation_step). The
    /// planes go into the JPEG as they are: no colours are converted. An error if the planes are
    /// empty, differ in size, or are larger than what TextureDecoder takes.
    Expected<void> encode(const TextureCrop& crop, int quality, CodedTexture& out);
    /// `divisor` 1 or 2: with 2 the colours are coded at half of the width and height of the mask,
    /// rounded up, each the mean of up to four. The mask stays as it is.
    Expected<void> encode(const TextureCrop& crop, int quality, int divisor, CodedTexture& out);

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Holds the JPEG library's state and memory that is reused; one per thread.
class TextureDecoder {
public:
    TextureDecoder();
    ~TextureDecoder();
    TextureDecoder(TextureDecoder&&) noexcept;
    TextureDecoder& operator=(TextureDecoder&&) noexcept;

    /// Reverse of TextureEncoder::encode: the result is as large as the mask, whatever the colours
    /// were coded at. Both byte strings may come from anywhere: what is
    /// damaged, too large, not of the kind that the encoder writes, or differs in size between
    /// colour and mask (but for that divisor of 2), is an error. On error, `out` is undefined.
    /// Damage that still makes a valid picture of that size shows wrong pixels, nothing worse.
    Expected<void> decode(std::span<const std::uint8_t> colour,
                          std::span<const std::uint8_t> mask,
                          DecodedTexture& out);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace atrium::codec
