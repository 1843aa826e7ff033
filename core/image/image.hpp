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

/// Resizes a plane; all pixels become 0. Keeps a plane that already has the size.
inline void resize(Plane& plane, int width, int height) {
    if (plane.width != width || plane.height != height) plane = Plane(width, height);
}

/// A binary picture: each pixel is 0 (background) or 255 (foreground).
using Mask = Plane;

/// The picture format of a site: full-range BT.601 Y'CbCr (as in JPEG), luma at full and chroma at
/// half resolution (4:2:0, chroma sited at the centre of its 2x2 block). Width and height are even.
///
/// No stage converts colours: segmentation reads Y, U and V directly, and the half-resolution
/// texture is U and V with a halved Y.
struct YuvImage {
    Plane y;
    Plane u;  // y.width / 2 by y.height / 2
    Plane v;

    int width() const { return y.width; }
    int height() const { return y.height; }
};

/// Colour filter pattern of a sensor, named by the first two pixels of its first row.
enum class Mosaic : std::uint8_t { kNone, kRG, kGR, kGB, kBG };

/// A view of a plane; does not own the memory.
struct PlaneView {
    int width = 0;
    int height = 0;
    std::ptrdiff_t stride_bytes = 0;
    const std::uint8_t* data = nullptr;

    PlaneView() = default;
    PlaneView(int width_px, int height_px, std::ptrdiff_t stride, const std::uint8_t* bytes)
        : width(width_px), height(height_px), stride_bytes(stride), data(bytes) {}
    PlaneView(const Plane& plane)  // NOLINT(google-explicit-constructor): a view of it
        : PlaneView(plane.width, plane.height, plane.width, plane.data.data()) {}

    const std::uint8_t* row(int y) const { return data + y * stride_bytes; }
    std::uint8_t at(int x, int y) const { return row(y)[x]; }
};

/// A view of a picture in the form of YuvImage; does not own the memory. If `mosaic` is not kNone,
/// `y` holds the sensor's samples instead of luma, each in the colour of its filter.
struct YuvView {
    PlaneView y;
    PlaneView u;
    PlaneView v;
    Mosaic mosaic = Mosaic::kNone;

    YuvView() = default;
    YuvView(const YuvImage& image)  // NOLINT(google-explicit-constructor): a view of it
        : y(image.y), u(image.u), v(image.v) {}

    int width() const { return y.width; }
    int height() const { return y.height; }
};

/// Position of the red sample in each 2x2 block of a mosaic; blue is diagonally opposite.
struct RedAt {
    int x = 0;
    int y = 0;
};
inline RedAt red_at(Mosaic mosaic) {
    return {mosaic == Mosaic::kGR || mosaic == Mosaic::kBG ? 1 : 0,
            mosaic == Mosaic::kGB || mosaic == Mosaic::kBG ? 1 : 0};
}

/// Luma of a 2x2 block of a mosaic, from its red, its blue and the sum of its two greens.
inline std::uint8_t luma_of_block(int red, int green_sum, int blue) {
    return static_cast<std::uint8_t>((9798 * red + 9617 * green_sum + 3736 * blue + (1 << 14)) >>
                                     15);
}

/// Rectangle of pixels: columns [x, x + width), rows [y, y + height).
struct PixelRect {
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;

    bool empty() const { return width <= 0 || height <= 0; }
    bool operator==(const PixelRect&) const = default;
};

/// Converts packed 8-bit BGR (rows of `stride_bytes`) into `out`. Resizes the planes only if the
/// size changes. Drops the last column or row of an odd size.
void yuv_from_bgr(
    const std::uint8_t* bgr, int width, int height, std::size_t stride_bytes, YuvImage& out);

}  // namespace atrium::image
