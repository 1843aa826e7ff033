#include "viewer/renderer/inverse_depth.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace atrium::renderer {
namespace {

struct Span {
    int begin;
    int end;  // inclusive
};

Span pixels_between(float low, float high, int size) {
    const float last = static_cast<float>(size - 1);
    return {static_cast<int>(std::ceil(std::clamp(low, 0.0f, last + 1.0f))),
            static_cast<int>(std::floor(std::clamp(high, -1.0f, last)))};
}

// Returns how many pixels it looked at.
std::int64_t draw_triangle(const Eigen::Vector3f& a,
                           const Eigen::Vector3f& b,
                           const Eigen::Vector3f& c,
                           InverseDepthPicture& picture) {
    const Eigen::Vector2f ab = (b - a).head<2>();
    const Eigen::Vector2f ac = (c - a).head<2>();
    // y points down in pictures: what is counter-clockwise from outside has negative area here
    const float area = ab.x() * ac.y() - ab.y() * ac.x();
    if (!(area < 0.0f)) return 0;
    const auto [x0, x1] = pixels_between(
        std::min({a.x(), b.x(), c.x()}), std::max({a.x(), b.x(), c.x()}), picture.width);
    const auto [y0, y1] = pixels_between(
        std::min({a.y(), b.y(), c.y()}), std::max({a.y(), b.y(), c.y()}), picture.height);

    // barycentric coordinates of b and c as affine functions of the pixel
    const float inverse_area = 1.0f / area;
    const float b_x = ac.y() * inverse_area;
    const float b_y = -ac.x() * inverse_area;
    const float c_x = -ab.y() * inverse_area;
    const float c_y = ab.x() * inverse_area;
    const float slope_b = b.z() - a.z();
    const float slope_c = c.z() - a.z();
    for (int y = y0; y <= y1; ++y) {
        const float dy = static_cast<float>(y) - a.y();
        float* row = picture.values.data() + static_cast<std::ptrdiff_t>(y) * picture.width;
        for (int x = x0; x <= x1; ++x) {
            const float dx = static_cast<float>(x) - a.x();
            const float weight_b = b_x * dx + b_y * dy;
            const float weight_c = c_x * dx + c_y * dy;
            if (weight_b < 0.0f || weight_c < 0.0f || weight_b + weight_c > 1.0f) continue;
            row[x] = std::max(row[x], a.z() + weight_b * slope_b + weight_c * slope_c);
        }
    }
    return std::int64_t{std::max(x1 - x0 + 1, 0)} * std::max(y1 - y0 + 1, 0);
}

}  // namespace

float InverseDepthPicture::nearest_around(float x, float y) const {
    const int cx = static_cast<int>(std::lround(x));
    const int cy = static_cast<int>(std::lround(y));
    float nearest = 0.0f;
    for (int py = std::max(cy - 1, 0); py <= std::min(cy + 1, height - 1); ++py) {
        const float* row = values.data() + static_cast<std::ptrdiff_t>(py) * width;
        for (int px = std::max(cx - 1, 0); px <= std::min(cx + 1, width - 1); ++px)
            nearest = std::max(nearest, row[px]);
    }
    return nearest;
}

void draw_inverse_depth(std::span<const Eigen::Vector3f> corners,
                        std::span<const std::array<std::uint32_t, 3>> triangles,
                        InverseDepthPicture& picture) {
    picture.values.assign(
        static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height), 0.0f);
    // a person takes three or four times the picture; what is no surface of anything ends here
    constexpr std::int64_t kMostTimes = 50;
    std::int64_t left = kMostTimes * picture.width * picture.height;
    for (const auto& [ia, ib, ic] : triangles) {
        if (left <= 0) break;
        const Eigen::Vector3f& a = corners[ia];
        const Eigen::Vector3f& b = corners[ib];
        const Eigen::Vector3f& c = corners[ic];
        if (a.z() > 0.0f && b.z() > 0.0f && c.z() > 0.0f) left -= draw_triangle(a, b, c, picture);
    }
}

}  // namespace atrium::renderer
