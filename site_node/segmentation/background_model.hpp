#pragma once

#include "core/base/expected.hpp"
#include "core/image/image.hpp"
#include "site_node/segmentation/segmentation_options.hpp"

#include <cstdint>
#include <vector>

namespace atrium::segmentation {

/// What the empty room looks like, as the integers that the per-pixel test needs. Luma: one
/// interval per pixel. Chroma: one Gaussian per 2x2 block. Made by BackgroundLearner; the vectors'
/// lengths follow from `width` and `height`.
struct BackgroundModel {
    int width = 0;   // of the luma, even
    int height = 0;  // even

    // per pixel: what is outside [luma_low, luma_high] is foreground whatever its colour
    std::vector<std::uint8_t> luma_low;
    std::vector<std::uint8_t> luma_high;

    // per block: expected chroma is ratio * luma; a darker patch of the same surface keeps its
    // ratio
    std::vector<std::int16_t> ratio_u;  // (mean U - 128) / (mean Y), in 1/4096
    std::vector<std::int16_t> ratio_v;

    // per block: (du, dv) -> (whiten_u du, whiten_uv du + whiten_v dv) has unit covariance; in
    // 1/32768
    std::vector<std::int16_t> whiten_u;
    std::vector<std::int16_t> whiten_uv;
    std::vector<std::int16_t> whiten_v;

    std::int32_t max_distance_sq = 0;  // of whitened chroma, in 1/4096
};

/// Learns from pictures of the empty room.
class BackgroundLearner {
public:
    /// Any number of frames of one size, even and not empty; the first one sets the size.
    Expected<void> add(const image::YuvView& frame);

    /// An error if no frame was added. One frame is enough (its noise is then taken from the
    /// options' floors).
    Expected<BackgroundModel> finish(const SegmentationOptions& options) const;

    int num_frames() const { return num_frames_; }

private:
    int num_frames_ = 0;
    int width_ = 0;
    int height_ = 0;
    std::vector<std::uint32_t> sum_y_, sum_yy_;  // per pixel
    std::vector<float> sum_u_, sum_v_, sum_uu_, sum_uv_,
        sum_vv_;  // per block, of U - 128 and V - 128
};

}  // namespace atrium::segmentation
