#pragma once

#include "site_node/segmentation/segmentation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

/// A room that is a smooth gradient, and changes to its pictures.
namespace atrium::segmentation::test {

struct Colour {
    double y, u, v;
};

inline image::YuvImage plain(int width, int height, Colour c) {
    const auto byte = [](double value) {
        return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
    };
    return {image::Plane(width, height, byte(c.y)),
            image::Plane(width / 2, height / 2, byte(c.u)),
            image::Plane(width / 2, height / 2, byte(c.v))};
}

// Smooth colours over the whole range of a lit wall.
inline image::YuvImage room(int width, int height) {
    image::YuvImage frame = plain(width, height, {0, 128, 128});
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x)
            frame.y.row(y)[x] = static_cast<std::uint8_t>(70 + 130 * x / width);
    }
    for (int y = 0; y < height / 2; ++y) {
        for (int x = 0; x < width / 2; ++x) {
            const double luma = frame.y.at(2 * x, 2 * y);
            frame.u.row(y)[x] =
                static_cast<std::uint8_t>(std::lround(128 + luma * (0.3 * y / height - 0.1)));
            frame.v.row(y)[x] = static_cast<std::uint8_t>(std::lround(128 - luma * 0.15));
        }
    }
    return frame;
}

inline void add_noise(image::YuvImage& frame,
                      double sigma_luma,
                      double sigma_chroma,
                      std::mt19937& random) {
    const auto shake = [&](image::Plane& plane, double sigma) {
        std::normal_distribution<double> noise(0.0, sigma);
        for (std::uint8_t& value : plane.data) {
            value =
                static_cast<std::uint8_t>(std::clamp(std::lround(value + noise(random)), 0L, 255L));
        }
    };
    shake(frame.y, sigma_luma);
    shake(frame.u, sigma_chroma);
    shake(frame.v, sigma_chroma);
}

// Multiplies the light in a rectangle with sharp edges.
inline void scale_light(image::YuvImage& frame, const image::PixelRect& area, double factor) {
    for (int y = area.y; y < area.y + area.height; ++y) {
        for (int x = area.x; x < area.x + area.width; ++x) {
            std::uint8_t& luma = frame.y.row(y)[x];
            luma = static_cast<std::uint8_t>(std::min(255L, std::lround(factor * luma)));
        }
    }
    for (image::Plane* plane : {&frame.u, &frame.v}) {
        for (int y = area.y / 2; y < (area.y + area.height) / 2; ++y) {
            for (int x = area.x / 2; x < (area.x + area.width) / 2; ++x) {
                std::uint8_t& chroma = plane->row(y)[x];
                chroma = static_cast<std::uint8_t>(std::lround(128 + factor * (chroma - 128)));
            }
        }
    }
}

inline BackgroundStatistics learn(const image::YuvImage& scene,
                                  int num_frames,
                                  std::mt19937& random,
                                  double sigma = 2.0) {
    BackgroundLearner learner;
    for (int i = 0; i < num_frames; ++i) {
        image::YuvImage frame = scene;
        add_noise(frame, sigma, 0.5 * sigma, random);
        EXPECT_TRUE(learner.add(frame).has_value());
    }
    return learner.finish().value();
}

// Fraction of the pixels of `area` that are foreground.
inline double foreground_part(const image::Mask& mask, const image::PixelRect& area) {
    double count = 0;
    for (int y = area.y; y < area.y + area.height; ++y) {
        for (int x = area.x; x < area.x + area.width; ++x) count += mask.at(x, y) != 0;
    }
    return count / (area.width * area.height);
}

constexpr image::PixelRect kPatch{60, 40, 80, 60};
constexpr image::PixelRect kPatchCore{64, 44, 72, 52};
constexpr image::PixelRect kWhole{0, 0, 240, 160};

}  // namespace atrium::segmentation::test
