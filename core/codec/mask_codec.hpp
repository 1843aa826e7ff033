#pragma once

#include "core/base/expected.hpp"
#include "core/image/image.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::codec {

/// Largest side of a mask or texture [px]: half of the largest allowed camera picture (8192).
constexpr int kMaxTextureSide = 4096;
/// Most pixels of a mask or texture: a whole 16 MP picture, 4:3, at half resolution. Decoders
/// reject more.
constexpr int kMaxTexturePixels = 4 << 20;

/// True if the size is neither empty nor beyond these limits.
constexpr bool is_texture_size(int width, int height) {
    return width > 0 && height > 0 && width <= kMaxTextureSide && height <= kMaxTextureSide &&
           width * height <= kMaxTexturePixels;
}

/// Codes a mask by the columns at which each row changes between background and foreground,
/// relative to the row above: about 3 bits per change. `mask` has a texture size.
///
/// Format, version 1: one byte 1; width and height as 16-bit little-endian; then bits, most
/// significant first. A row has changes at columns c_1 < c_2 < ..., the first to foreground. If it
/// has as many as the row above: bit 1, then the signed Exp-Golomb codes of c_k - (c_k above).
/// Else: bit 0, the unsigned Exp-Golomb code of their number, then those of c_1, c_2 - c_1 - 1, ...
/// The row above the first has no changes. Unused bits of the last byte are 0.
void encode_mask(const image::Mask& mask, std::vector<std::uint8_t>& out);

/// Decodes the result of encode_mask. Safe for untrusted input: fails with kInvalidData unless
/// `bytes` is exactly one coded mask; `out` is then undefined.
Expected<void> decode_mask(std::span<const std::uint8_t> bytes, image::Mask& out);

}  // namespace atrium::codec
