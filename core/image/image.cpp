#include "core/image/image.hpp"

#include "core/image/colour_rows.hpp"

#include <algorithm>

namespace atrium::image {
namespace {

// Full-range BT.601 in 16.16 fixed point.
constexpr int kShift = 16;
constexpr int kHalf = 1 << (kShift - 1);
constexpr int fixed(double v) { return static_cast<int>(v * (1 << kShift) + (v < 0 ? -0.5 : 0.5)); }

void resize(Plane& plane, int width, int height) {
    if (plane.width == width && plane.height == height) return;
    plane = Plane(width, height);
}

std::uint8_t clamp_byte(int v) { return static_cast<std::uint8_t>(std::clamp(v, 0, 255)); }

// Of the blocks in rows y and y + 1, each twice.
void luma_of_mosaic(const YuvView& image, int y, std::vector<std::uint8_t>& luma) {
    const RedAt red = red_at(image.mosaic);
    const std::uint8_t* red_row = image.y.row(y + red.y);
    const std::uint8_t* blue_row = image.y.row(y + 1 - red.y);
    for (int x = 0; x + 1 < image.width(); x += 2) {
        const int green = red_row[x + 1 - red.x] + blue_row[x + red.x];
        const auto at = static_cast<std::size_t>(x);
        luma[at] = luma[at + 1] = luma_of_block(red_row[x + red.x], green, blue_row[x + 1 - red.x]);
    }
}

void yuv_from_packed(const std::uint8_t* pixels,
                     int width,
                     int height,
                     std::size_t stride_bytes,
                     bool blue_first,
                     YuvImage& out) {
    const int even_width = width & ~1;
    const int even_height = height & ~1;
    resize(out.y, even_width, even_height);
    resize(out.u, even_width / 2, even_height / 2);
    resize(out.v, even_width / 2, even_height / 2);
    const RowCode code = best_row_code();
    for (int y = 0; y < even_height; y += 2) {
        const std::uint8_t* top = pixels + static_cast<std::size_t>(y) * stride_bytes;
        yuv_of_packed_rows({top, top + stride_bytes, even_width, blue_first},
                           {out.y.row(y), out.y.row(y + 1), out.u.row(y / 2), out.v.row(y / 2)},
                           code);
    }
}

}  // namespace

void yuv_from_bgr(
    const std::uint8_t* bgr, int width, int height, std::size_t stride_bytes, YuvImage& out) {
    yuv_from_packed(bgr, width, height, stride_bytes, true, out);
}

void yuv_from_rgb(
    const std::uint8_t* rgb, int width, int height, std::size_t stride_bytes, YuvImage& out) {
    yuv_from_packed(rgb, width, height, stride_bytes, false, out);
}

std::vector<std::uint8_t> bgr_from_yuv(const YuvView& image) {
    std::vector<std::uint8_t> bgr(static_cast<std::size_t>(image.width()) *
                                  static_cast<std::size_t>(image.height()) * 3);
    std::vector<std::uint8_t> block_luma;
    for (int y = 0; y < image.height(); ++y) {
        const std::uint8_t* luma = image.y.row(y);
        if (image.mosaic != Mosaic::kNone) {
            block_luma.resize(static_cast<std::size_t>(image.width()));
            luma_of_mosaic(image, y & ~1, block_luma);
            luma = block_luma.data();
        }
        const std::uint8_t* cb = image.u.row(y / 2);
        const std::uint8_t* cr = image.v.row(y / 2);
        std::uint8_t* out =
            bgr.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width()) * 3;
        for (int x = 0; x < image.width(); ++x) {
            const int u = cb[x / 2] - 128;
            const int v = cr[x / 2] - 128;
            const int scaled = luma[x] << kShift;
            out[3 * x] = clamp_byte((scaled + fixed(1.772) * u + kHalf) >> kShift);
            out[3 * x + 1] = clamp_byte(
                (scaled + fixed(-0.344136) * u + fixed(-0.714136) * v + kHalf) >> kShift);
            out[3 * x + 2] = clamp_byte((scaled + fixed(1.402) * v + kHalf) >> kShift);
        }
    }
    return bgr;
}

}  // namespace atrium::image
