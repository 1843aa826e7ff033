#pragma once

#include "core/image/image.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace atrium::calibrate {

struct DetectionOptions {
    /// The brightest pixels of a light are this many grey levels above the picture's background; 0:
    /// as the noise of the picture asks.
    double threshold = 0.0;
};

/// A bright spot that has the size and the shape of a light.
struct DetectedLight {
    /// Centroid of what is above the local background: the middle of the exposure if the light
    /// moves. Distorted, pixel centres at integer coordinates.
    Eigen::Vector2d px = Eigen::Vector2d::Zero();
    double contrast = 0.0;  // of its brightest pixel to the local background [grey levels]
    double length_px = 0.0, width_px = 0.0;  // of the area above half of the contrast
};

/// What the picture of one camera shows.
struct DetectedLights {
    std::vector<DetectedLight> lights;  // strongest first; at most kMostLights
    double background = 0.0;            // median [grey levels]
    double noise = 0.0;                 // standard deviation [grey levels]
    double threshold = 0.0;             // that was taken, above `background` [grey levels]
    std::size_t num_large = 0;          // bright areas that are larger than a light
    std::size_t num_specks = 0;         // single bright pixels
};

inline constexpr std::size_t kMostLights = 64;

/// Finds spots of 3 to 12 px, up to 60 px long if they move, in a picture that was exposed for
/// lights. Larger areas, other shapes, hot pixels and spots that the border cuts are left out, and
/// so are spots with less than a tenth of the contrast of the strongest one.
///
/// The centre is good to 0.1 px if the contrast is ten times the noise. Of a mosaic, blocks of 2 x
/// 2 samples are averaged first. Reads dark parts once, eight pixels at a time.
class LightDetector {
public:
    explicit LightDetector(const DetectionOptions& options) : options_(options) {}

    /// `found` is reusable. Not thread-safe.
    void detect(const image::YuvView& picture, DetectedLights& found);

private:
    struct Bright {
        int x = 0, y = 0;
        float value = 0.0F;
    };
    void measure_background(const image::PlaneView& picture, DetectedLights& found) const;
    void find_in_block(const image::PlaneView& picture, int x0, int y0, DetectedLights& found);
    void flood(const image::PlaneView& picture, int x, int y);
    void examine(const image::PlaneView& picture, DetectedLights& found);
    void take_spot(const std::vector<Bright>& spot,
                   double floor,
                   double contrast,
                   DetectedLights& found) const;
    std::vector<std::vector<Bright>> parts_above(double level) const;
    double ring_background(const image::PlaneView& picture) const;
    std::size_t fewest_pixels() const;
    float value_at(const image::PlaneView& picture, int x, int y) const;

    DetectionOptions options_;
    bool is_mosaic_ = false;
    int limit_ = 255;      // a pixel above it begins a bright area
    float grow_ = 255.0F;  // which then grows over pixels above this
    int width_ = 0, height_ = 0;
    std::vector<std::uint8_t> visited_;  // per pixel
    std::vector<Bright> area_;           // connected bright pixels; the first kMostPixels
    std::size_t area_size_ = 0;          // all of them
    std::vector<std::pair<int, int>> stack_;
    std::vector<std::uint32_t> dirty_;  // pixels of visited_ to clear
};

}  // namespace atrium::calibrate
