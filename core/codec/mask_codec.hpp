#pragma once

#include "core/base/expected.hpp"
#include "core/image/image.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::codec {

/// Largest side of a mask or texture: half of the largest picture of a camera that a site may have
/// (8192).
constexpr int kMaxTextureSide = 4096;
/// More pixels than this are not decoded, whatever a header says: a 4:3 picture at half of 16 MP,
/// cut out whole.
constexpr int kMaxTexturePixels = 4 << 20;

/// Neither empty nor larger than these limits.
constexpr bool is_texture_size(int width, int height) {
    return width > 0 && height > 0 && width <= kMaxTextureSide && height <= kMaxTextureSide &&
           width * height <= kMaxTexturePixels;
}

/// Codes where each row changes between background and foreground, relative to the row above: about
/// 3 bits for each change.
///
/// Format, version 1: one byte 1; width and height as 16-bit little-endian; then bits, most
/// significant first. A row with changes at columns c_1 < c_2 < ... (the first one to foreground):
/// bit 1 if there are as many as in the row above, then the signed Exp-Golomb codes of c_k - (c_k
/// above); else bit 0, the unsigned Exp-Golomb code of their number, and those of c_1, c_2 - c_1 -
/// 1, ... The row above the first has no changes. Unused bits of the last byte are 0.
///
/// `mask` has a texture size.
void encode_mask(const image::Mask& mask, std::vector<std::uint8_t>& out);

/// Reverse of encode_mask. `bytes` may come from anywhere: what is not exactly one coded mask is an
/// error. On error, the content of `out` is undefined.
Expected<void> decode_mask(std::span<const std::uint8_t> bytes, image::Mask& out);

}  // namespace atrium::codec
