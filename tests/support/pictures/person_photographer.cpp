#include "tests/support/pictures/person_photographer.hpp"

#include <glad/gl.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>

namespace atrium::test {
namespace {

// Samples per pixel and direction. An odd number has one at the centre. Other samples count only
// where the lens bends, and are then so near that they blur almost nothing.
constexpr int samples_of(Sampling sampling) { return sampling == Sampling::kMean ? 2 : 3; }

constexpr std::uint8_t kGrey = 128;

// GL's projection of a camera's undistorted pixels, with the top row at the top of clip space.
Eigen::Matrix4d clip_from_camera(const geometry::PinholeCamera& c) {
    constexpr double kNear_m = 0.05;
    constexpr double kFar_m = 30.0;
    Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
    m.row(0) << 2.0 * c.fx / c.width, 2.0 * c.skew / c.width, 2.0 * (c.cx + 0.5) / c.width - 1.0,
        0.0;
    m.row(1) << 0.0, -2.0 * c.fy / c.height, 1.0 - 2.0 * (c.cy + 0.5) / c.height, 0.0;
    m.row(2) << 0.0, 0.0, (kFar_m + kNear_m) / (kFar_m - kNear_m),
        -2.0 * kFar_m * kNear_m / (kFar_m - kNear_m);
    m.row(3) << 0.0, 0.0, 1.0, 0.0;
    return m;
}

constexpr double kLeastCoverage = 0.01;

// Sums of some samples.
struct Sum {
    Eigen::Vector3d rgb = Eigen::Vector3d::Zero();  // times opacity
    double alpha = 0.0;
    double opacity = 0.0;  // of the most opaque one, in [0, 1]

    void add(double weight, const Sum& other) {
        if (weight <= 0.0) return;
        rgb += weight * other.rgb;
        alpha += weight * other.alpha;
        opacity = std::max(opacity, other.opacity);
    }
};

// The samples around one pixel.
class Samples {
public:
    Samples(const std::vector<std::uint8_t>& rgba, int width, int height, Sampling sampling)
        : rgba_(rgba), width_(width), height_(height), sampling_(sampling) {}

    Sum pixel(double x, double y) const {
        const int n = samples_of(sampling_);
        if (sampling_ == Sampling::kCentre) {
            const Sum centre = at((x + 0.5) * n - 0.5, (y + 0.5) * n - 0.5);
            if (centre.alpha >= kLeastCoverage) return centre;
        }
        Sum sum;
        for (const double dy : {-0.25, 0.25}) {
            for (const double dx : {-0.25, 0.25})
                sum.add(1.0, at((x + dx + 0.5) * n - 0.5, (y + dy + 0.5) * n - 0.5));
        }
        return sum;
    }

private:
    // At (x, y) from the top, linearly interpolated.
    Sum at(double x, double y) const {
        const auto x0 = static_cast<int>(std::floor(x));
        const auto y0 = static_cast<int>(std::floor(y));
        const double u = x - x0;
        const double v = y - y0;
        Sum sum;
        sum.add((1 - v) * (1 - u), sample(x0, y0));
        sum.add((1 - v) * u, sample(x0 + 1, y0));
        sum.add(v * (1 - u), sample(x0, y0 + 1));
        sum.add(v * u, sample(x0 + 1, y0 + 1));
        return sum;
    }
    Sum sample(int x, int y) const {
        if (x < 0 || y < 0 || x >= width_ || y >= height_) return {};
        const std::uint8_t* p =
            rgba_.data() + 4 * (static_cast<std::ptrdiff_t>(height_ - 1 - y) * width_ + x);
        const double alpha = p[3] / 255.0;
        return {Eigen::Vector3d(p[0], p[1], p[2]), alpha, alpha};
    }
    const std::vector<std::uint8_t>& rgba_;
    int width_;
    int height_;
    Sampling sampling_;
};

// Bounds of the covered samples, widened by the bend of the lens. Pixels outside are skipped.
image::PixelRect painted_rect(const std::vector<std::uint8_t>& rgba,
                              int width,
                              int height,
                              int num_samples) {
    int x0 = width, y0 = height, x1 = -1, y1 = -1;
    for (int y = 0; y < height; ++y) {
        const std::uint8_t* row =
            rgba.data() + 4 * static_cast<std::ptrdiff_t>(height - 1 - y) * width;
        for (int x = 0; x < width; ++x) {
            if (row[4 * x + 3] == 0) continue;
            x0 = std::min(x0, x);
            x1 = std::max(x1, x);
            y0 = std::min(y0, y);
            y1 = std::max(y1, y);
        }
    }
    const int margin = width / 20;
    const auto low = [&](int v) { return std::max(v - margin, 0) / num_samples; };
    const auto high = [&](int v, int size) { return std::min(v + margin, size - 1) / num_samples; };
    if (x1 < 0) return {};
    return {low(x0), low(y0), high(x1, width) - low(x0) + 1, high(y1, height) - low(y0) + 1};
}

}  // namespace

Expected<PersonPhotographer> PersonPhotographer::create(Sampling sampling) {
    auto context = gl::OffscreenContext::create(8, 8);
    if (!context) return tl::unexpected(context.error());
    PersonPhotographer photographer(std::move(*context), sampling);
    auto shaders = renderer::PersonShaders::create();
    if (!shaders) return tl::unexpected(shaders.error());
    photographer.shaders_ = std::move(*shaders);
    return photographer;
}

Photo PersonPhotographer::take(const geometry::CalibratedCamera& camera, const Paint& paint) {
    const geometry::PinholeCamera& lens = camera.intrinsics;
    const int width = samples_of(sampling_) * lens.width;
    const int height = samples_of(sampling_) * lens.height;
    if (target_.width != width || target_.height != height) {
        auto target = gl::make_framebuffer(width, height);
        if (!target) std::abort();  // only for lack of memory
        target_ = std::move(*target);
    }
    target_.bind();
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    glDisable(GL_BLEND);
    glDisable(GL_SCISSOR_TEST);
    glClearColor(0.0F, 0.0F, 0.0F, 0.0F);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    paint(clip_from_camera(lens) * camera.camera_from_site.matrix(), camera.centre_site());
    samples_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
    gl::read_rgba(width, height, samples_);

    Photo photo{lens.width, lens.height, {}, image::Mask(lens.width, lens.height)};
    photo.bgr.assign(photo.opacity.data.size() * 3, kGrey);
    const Samples samples(samples_, width, height, sampling_);
    const image::PixelRect rect = painted_rect(samples_, width, height, samples_of(sampling_));
    for (int y = rect.y; y < rect.y + rect.height; ++y) {
        for (int x = rect.x; x < rect.x + rect.width; ++x) {
            Eigen::Vector2d at(x, y);
            if (lens.has_distortion()) {
                const auto straight = lens.undistort(at);
                if (!straight) continue;
                at = *straight;
            }
            const Sum sum = samples.pixel(at.x(), at.y());
            if (sum.alpha < kLeastCoverage) continue;
            const std::size_t i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(lens.width) +
                static_cast<std::size_t>(x);
            photo.opacity.data[i] = static_cast<std::uint8_t>(std::lround(255.0 * sum.opacity));
            const Eigen::Vector3d grey = Eigen::Vector3d::Constant((1.0 - sum.opacity) * kGrey);
            const Eigen::Vector3d rgb =
                (sum.rgb * (sum.opacity / sum.alpha) + grey).cwiseMin(255.0);
            for (std::size_t c = 0; c < 3; ++c)
                photo.bgr[3 * i + c] =
                    static_cast<std::uint8_t>(std::lround(rgb[2 - static_cast<Eigen::Index>(c)]));
        }
    }
    return photo;
}

Photo PersonPhotographer::take(const geometry::CalibratedCamera& camera,
                               renderer::PersonDrawing& person) {
    return take(camera, [&](const Eigen::Matrix4d& clip_from_site, const Eigen::Vector3d& eye) {
        person.draw(*shaders_, clip_from_site, eye);
        if (has_soft_outlines_) person.draw_outline(*shaders_, clip_from_site, eye, target_.height);
    });
}

}  // namespace atrium::test
