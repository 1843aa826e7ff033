#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace atrium::image {

/// One plane of bytes, rows without padding: pixel (x, y) is `data[y * width + x]`.
struct Plane {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> data;

    Plane() = default;
    Plane(int width_px, int height_px, std::uint8_t value = 0)
        : width(width_px),
          height(height_px),
          data(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px), value) {}

    const std::uint8_t* row(int y) const {
        return data.data() + static_cast<std::ptrdiff_t>(y) * width;
    }
    std::uint8_t* row(int y) { return data.data() + static_cast<std::ptrdiff_t>(y) * width; }
    std::uint8_t at(int x, int y) const { return row(y)[x]; }
};

/// A binary picture: 0 = background, 255 = foreground; nothing else.
using Mask = Plane;

/// What a camera delivers, in the form in which the whole site works: full-range BT.601 Y'CbCr
/// (JPEG's), luma at full and chroma at half resolution (4:2:0, chroma sited in the middle of its
/// 2x2 block). Width and height are even.
///
/// Segmentation reads Y and UV as they are, and the half-resolution texture is U and V as they are
/// plus a halved Y: no stage converts colours.
struct YuvImage {
    Plane y;
    Plane u;  // y.width / 2 by y.height / 2
    Plane v;

    int width() const { return y.width; }
    int height() const { return y.height; }
};

/// Rectangle of pixels: columns [x, x + width), rows [y, y + height).
struct PixelRect {
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;

    bool empty() const { return width <= 0 || height <= 0; }
    bool operator==(const PixelRect&) const = default;
};

/// Converts packed 8-bit BGR (rows of `stride_bytes`) into `out`, whose planes are resized only
/// when the size changes. Odd sizes lose their last column or row.
void yuv_from_bgr(
    const std::uint8_t* bgr, int width, int height, std::size_t stride_bytes, YuvImage& out);

/// The reverse, for pictures that people look at: packed BGR, 3 * width * height bytes.
std::vector<std::uint8_t> bgr_from_yuv(const YuvImage& image);

}  // namespace atrium::image
