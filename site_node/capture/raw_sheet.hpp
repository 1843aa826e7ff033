#pragma once

#include "core/image/raw_image.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// Raw pictures as plain bytes, and as one grey picture that codecs compress well.
namespace atrium::capture {

/// Layout of a raw picture without padding: all its planes, row by row, one after the other.
struct RawLayout {
    image::PixelFormat format = image::PixelFormat::kYuv420;
    int width = 0;
    int height = 0;

    bool operator==(const RawLayout&) const = default;
};

/// Largest width and height that a layout may have.
inline constexpr int kMaxRawSize_px = 8192;

/// False for sizes below 2 or above kMaxRawSize_px, and for odd ones of kYuv420.
bool is_valid(const RawLayout& layout);

RawLayout layout_of(const image::RawImage& picture);

/// Bytes of a picture. `layout` must be valid.
std::size_t packed_bytes(const RawLayout& layout);

/// Copies the picture, which must not be empty, without padding. Resizes `out`, which keeps its
/// memory.
void pack(const image::RawImage& picture, std::vector<std::uint8_t>& out);

/// Refers to packed bytes, which become part of the picture. Their number must fit `layout`.
image::RawImage unpack(const RawLayout& layout, std::vector<std::uint8_t> bytes);

/// Size of the sheet: a grey picture of the same bytes, in which neighbours show the same colour.
/// A mosaic has its four colours in the four quarters. Packed colours are one below the other.
struct SheetSize {
    int width = 0;
    int height = 0;
};
SheetSize sheet_size(const RawLayout& layout);

/// Writes packed bytes in the order of the sheet. `sheet` has the same number of bytes.
void to_sheet(const RawLayout& layout,
              std::span<const std::uint8_t> packed,
              std::span<std::uint8_t> sheet);

/// The inverse of `to_sheet`.
void from_sheet(const RawLayout& layout,
                std::span<const std::uint8_t> sheet,
                std::span<std::uint8_t> packed);

}  // namespace atrium::capture
