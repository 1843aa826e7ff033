#pragma once

#include "core/base/expected.hpp"
#include "core/image/image.hpp"
#include "site_node/segmentation/segmentation_options.hpp"

#include <cstdint>
#include <vector>

namespace atrium::segmentation {

/// What was measured of the empty room by one camera; no option has a part in it. Luma: mean and
/// deviation per pixel (of a mosaic: per sample). Chroma: mean and covariance per 2x2 block. The
/// vectors' lengths follow from `width` and `height`.
struct BackgroundStatistics {
    int width = 0;   // of the luma, even
    int height = 0;  // even
    image::Mosaic mosaic = image::Mosaic::kNone;
    int num_frames = 0;

    std::vector<std::uint16_t> luma;       // mean, in 1/256
    std::vector<std::uint8_t> luma_sigma;  // in 1/4, rounded up
    std::vector<std::int16_t> u;           // mean of U - 128, in 1/128
    std::vector<std::int16_t> v;
    std::vector<std::int16_t> uu;  // covariance, in 1/16
    std::vector<std::int16_t> uv;
    std::vector<std::int16_t> vv;
};

/// The same as the integers that the per-pixel test needs, under given options.
///
/// `room` is what `luma`, `u` and `v` were learned as; where light drifts, what the thresholds are
/// made from moves away from it by a bounded amount (light_adaptation.hpp).
struct BackgroundModel {
    BackgroundStatistics room;
    std::vector<std::uint16_t> luma;  // as of now, in the units of `room`
    std::vector<std::int16_t> u;
    std::vector<std::int16_t> v;

    // per pixel: what is outside [luma_low, luma_high] is foreground whatever its colour
    std::vector<std::uint8_t> luma_low;
    std::vector<std::uint8_t> luma_high;

    // per block
    std::vector<std::uint8_t> darkest;  // part of its luma that is left in shadow, in 1/256
    // expected chroma is ratio * luma; a darker patch of the same surface keeps its ratio
    std::vector<std::int16_t> ratio_u;  // (mean U - 128) / (mean Y), in 1/4096
    std::vector<std::int16_t> ratio_v;
    // (du, dv) -> (whiten_u du, whiten_uv du + whiten_v dv) has unit covariance; in 1/32768. All 0
    // where the room is too dark to have a colour.
    std::vector<std::int16_t> whiten_u;
    std::vector<std::int16_t> whiten_uv;
    std::vector<std::int16_t> whiten_v;

    std::int32_t max_distance_sq = 0;  // of whitened chroma, in 1/4096
    std::int16_t min_colour_luma = 0;  // below this sum of a block's four lumas its chroma is none
    // from options, in the units of update_light
    std::int32_t luma_distance = 0;   // in 1/64 of a deviation
    std::int32_t min_luma_noise = 0;  // in 1/256
    std::int32_t highlight = 0;       // 1 + the part, in 1/256

    int width() const { return room.width; }
    int height() const { return room.height; }
};

/// Samples from here on may be clipped: what is brighter still looks the same, and once one
/// channel clips the colour is wrong.
constexpr std::uint8_t kClipped = 250;

/// Sizes of `statistics` agree with each other (as BackgroundLearner and load_background make
/// them).
BackgroundModel make_model(BackgroundStatistics statistics, const SegmentationOptions& options);

/// Makes thresholds and ratios of rows [first_row, end_row), both even, from the model's luma, u
/// and v.
void update_light(BackgroundModel& model, int first_row, int end_row);

/// Half of the interval of luma that noise alone takes up at this pixel, in 1/256.
inline std::int32_t luma_noise(const BackgroundModel& model, std::size_t pixel) {
    const std::int32_t noise = model.room.luma_sigma[pixel] * model.luma_distance;
    return noise > model.min_luma_noise ? noise : model.min_luma_noise;
}

/// Learns from pictures of the empty room.
class BackgroundLearner {
public:
    /// Any number of frames of one size, even and not empty, and one mosaic; the first one sets
    /// them.
    Expected<void> add(const image::YuvView& frame);

    /// An error if no frame was added. One frame is enough (its noise is then taken from the
    /// options' floors).
    Expected<BackgroundStatistics> finish() const;
    Expected<BackgroundModel> finish(const SegmentationOptions& options) const;

    int num_frames() const { return num_frames_; }

private:
    Expected<void> start_or_check(const image::YuvView& frame);

    int num_frames_ = 0;
    int width_ = 0;
    int height_ = 0;
    image::Mosaic mosaic_ = image::Mosaic::kNone;
    std::vector<std::uint32_t> sum_y_, sum_yy_;  // per pixel
    std::vector<std::int32_t> sum_u_, sum_v_;    // per block, of U - 128 and V - 128
    std::vector<std::int32_t> sum_uu_, sum_uv_, sum_vv_;
};

}  // namespace atrium::segmentation
