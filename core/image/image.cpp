#include "core/image/image.hpp"

#include <algorithm>

namespace atrium::image {
namespace {

// Full-range BT.601 in 16.16 fixed point.
constexpr int kShift = 16;
constexpr int kHalf = 1 << (kShift - 1);
constexpr int fixed(double v) { return static_cast<int>(v * (1 << kShift) + (v < 0 ? -0.5 : 0.5)); }
constexpr int kYR = fixed(0.299), kYB = fixed(0.114), kYG = (1 << kShift) - kYR - kYB;
constexpr int kUB = fixed(0.5), kUR = fixed(-0.168736), kUG = -kUB - kUR;
constexpr int kVR = fixed(0.5), kVB = fixed(-0.081312), kVG = -kVR - kVB;

void resize(Plane& plane, int width, int height) {
    if (plane.width == width && plane.height == height) return;
    plane = Plane(width, height);
}

std::uint8_t clamp_byte(int v) { return static_cast<std::uint8_t>(std::clamp(v, 0, 255)); }

void luma_row(const std::uint8_t* __restrict bgr, int width, std::uint8_t* __restrict y) {
    for (int x = 0; x < width; ++x) {
        y[x] = static_cast<std::uint8_t>(
            (kYB * bgr[3 * x] + kYG * bgr[3 * x + 1] + kYR * bgr[3 * x + 2] + kHalf) >> kShift);
    }
}

// Chroma of the mean of each 2x2 block.
void chroma_row(const std::uint8_t* __restrict top,
                const std::uint8_t* __restrict bottom,
                int half_width,
                std::uint8_t* __restrict u,
                std::uint8_t* __restrict v) {
    constexpr int kBias = (128 << (kShift + 2)) + (1 << (kShift + 1));
    for (int x = 0; x < half_width; ++x) {
        const int b = top[6 * x] + top[6 * x + 3] + bottom[6 * x] + bottom[6 * x + 3];
        const int g = top[6 * x + 1] + top[6 * x + 4] + bottom[6 * x + 1] + bottom[6 * x + 4];
        const int r = top[6 * x + 2] + top[6 * x + 5] + bottom[6 * x + 2] + bottom[6 * x + 5];
        u[x] = static_cast<std::uint8_t>(
            std::min((kUB * b + kUG * g + kUR * r + kBias) >> (kShift + 2), 255));
        v[x] = static_cast<std::uint8_t>(
            std::min((kVB * b + kVG * g + kVR * r + kBias) >> (kShift + 2), 255));
    }
}

}  // namespace

void yuv_from_bgr(
    const std::uint8_t* bgr, int width, int height, std::size_t stride_bytes, YuvImage& out) {
    const int even_width = width & ~1;
    const int even_height = height & ~1;
    resize(out.y, even_width, even_height);
    resize(out.u, even_width / 2, even_height / 2);
    resize(out.v, even_width / 2, even_height / 2);
    for (int y = 0; y < even_height; y += 2) {
        const std::uint8_t* top = bgr + static_cast<std::size_t>(y) * stride_bytes;
        const std::uint8_t* bottom = top + stride_bytes;
        luma_row(top, even_width, out.y.row(y));
        luma_row(bottom, even_width, out.y.row(y + 1));
        chroma_row(top, bottom, even_width / 2, out.u.row(y / 2), out.v.row(y / 2));
    }
}

std::vector<std::uint8_t> bgr_from_yuv(const YuvImage& image) {
    std::vector<std::uint8_t> bgr(image.y.data.size() * 3);
    for (int y = 0; y < image.height(); ++y) {
        const std::uint8_t* luma = image.y.row(y);
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
