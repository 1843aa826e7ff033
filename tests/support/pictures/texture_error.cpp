#include "tests/support/pictures/texture_error.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

namespace atrium::test {
namespace {

using Colour = std::array<double, 3>;

// full-range BT.601
Colour rgb_of(double y, double u, double v) {
    const double b = u - 128.0;
    const double r = v - 128.0;
    return {std::clamp(y + 1.402 * r, 0.0, 255.0),
            std::clamp(y - 0.344136 * b - 0.714136 * r, 0.0, 255.0),
            std::clamp(y + 1.772 * b, 0.0, 255.0)};
}

Colour yuv_of(const std::uint8_t* rgb) {
    const double y = 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2];
    return {y, 128.0 + (rgb[2] - y) / 1.772, 128.0 + (rgb[0] - y) / 1.402};
}

}  // namespace

double SampleError::psnr_db() const {
    if (sum_sq_ == 0.0) return std::numeric_limits<double>::infinity();
    return 10.0 * std::log10(255.0 * 255.0 * static_cast<double>(num_samples_) / sum_sq_);
}

TextureError texture_error(const codec::TextureCrop& original, const codec::DecodedTexture& shown) {
    assert(shown.width == original.width() && shown.height == original.height());
    TextureError error;
    for (std::size_t i = 0; i < original.mask.data.size(); ++i) {
        if (original.mask.data[i] == 0) continue;
        const Colour yuv{static_cast<double>(original.y.data[i]),
                         static_cast<double>(original.u.data[i]),
                         static_cast<double>(original.v.data[i])};
        const Colour rgb = rgb_of(yuv[0], yuv[1], yuv[2]);
        const std::uint8_t* pixel = shown.rgba.data() + 4 * i;
        const Colour shown_yuv = yuv_of(pixel);
        for (std::size_t c = 0; c < 3; ++c) error.rgb.add(rgb[c], pixel[c]);
        error.luma.add(yuv[0], shown_yuv[0]);
        for (std::size_t c = 1; c < 3; ++c) error.chroma.add(yuv[c], shown_yuv[c]);
    }
    return error;
}

}  // namespace atrium::test
