#include "core/image/image.hpp"

#include "core/image/block_luma.hpp"
#include "core/image/colour_rows.hpp"

#include <algorithm>

namespace atrium::image {
namespace {

// Full-range BT.601 in 16.16 fixed point.
constexpr int kShift = 16;
constexpr int kHalf = 1 << (kShift - 1);
constexpr int fixed(double v) { return static_cast<int>(v * (1 << kShift) + (v < 0 ? -0.5 : 0.5)); }

std::uint8_t clamp_byte(int v) { return static_cast<std::uint8_t>(std::clamp(v, 0, 255)); }

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
    // for a mosaic: luma per block
    std::vector<std::uint8_t> block_luma(static_cast<std::size_t>(image.width() / 2));
    const int pixels_per_luma = image.mosaic == Mosaic::kNone ? 1 : 2;
    for (int y = 0; y < image.height(); ++y) {
        const std::uint8_t* luma = image.y.row(y);
        if (image.mosaic != Mosaic::kNone) {
            luma = block_luma.data();
            luma_of_blocks(
                image, {0, y & ~1, image.width() / 2}, best_row_code(), block_luma.data());
        }
        const std::uint8_t* cb = image.u.row(y / 2);
        const std::uint8_t* cr = image.v.row(y / 2);
        std::uint8_t* out =
            bgr.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width()) * 3;
        for (int x = 0; x < image.width(); ++x) {
            const int u = cb[x / 2] - 128;
            const int v = cr[x / 2] - 128;
            const int scaled = luma[x / pixels_per_luma] << kShift;
            out[3 * x] = clamp_byte((scaled + fixed(1.772) * u + kHalf) >> kShift);
            out[3 * x + 1] = clamp_byte(
                (scaled + fixed(-0.344136) * u + fixed(-0.714136) * v + kHalf) >> kShift);
            out[3 * x + 2] = clamp_byte((scaled + fixed(1.402) * v + kHalf) >> kShift);
        }
    }
    return bgr;
}

}  // namespace atrium::image
