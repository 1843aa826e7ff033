#pragma once

#include "core/image/block_luma.hpp"
#include "core/image/colour_rows.hpp"
#include "core/image/image.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace atrium::test {

/// Converts a picture to packed BGR, 3 * width * height bytes. Each block of a mosaic becomes one
/// colour.
inline std::vector<std::uint8_t> bgr_from_yuv(const image::YuvView& view) {
    std::vector<std::uint8_t> bgr(static_cast<std::size_t>(view.width()) *
                                  static_cast<std::size_t>(view.height()) * 3);
    // full-range BT.601 in 16.16 fixed point
    constexpr int kShift = 16;
    constexpr int kHalf = 1 << (kShift - 1);
    const auto fixed = [](double v) { return static_cast<int>(std::lround(v * (1 << kShift))); };
    const auto clamp_byte = [](int v) { return static_cast<std::uint8_t>(std::clamp(v, 0, 255)); };
    // for a mosaic: luma per block
    std::vector<std::uint8_t> block_luma(static_cast<std::size_t>(view.width() / 2));
    const int pixels_per_luma = view.mosaic == image::Mosaic::kNone ? 1 : 2;
    for (int y = 0; y < view.height(); ++y) {
        const std::uint8_t* luma = view.y.row(y);
        if (view.mosaic != image::Mosaic::kNone) {
            luma = block_luma.data();
            image::luma_of_blocks(
                view, {0, y & ~1, view.width() / 2}, image::best_row_code(), block_luma.data());
        }
        const std::uint8_t* cb = view.u.row(y / 2);
        const std::uint8_t* cr = view.v.row(y / 2);
        std::uint8_t* out =
            bgr.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width()) * 3;
        for (int x = 0; x < view.width(); ++x) {
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

}  // namespace atrium::test
