#pragma once

#include "core/base/expected.hpp"
#include "core/image/image.hpp"
#include "site_node/segmentation/instruction_set.hpp"
#include "site_node/segmentation/segmentation_options.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace atrium::segmentation {

/// Measurements of the empty room by one camera, independent of options. Luma: mean and deviation
/// per pixel (of a mosaic: per sample). Chroma: mean and covariance per 2x2 block. `width` and
/// `height` determine the length of every vector.
struct BackgroundStatistics {
    int width = 0;   // of the luma plane, even
    int height = 0;  // even
    image::Mosaic mosaic = image::Mosaic::kNone;
    int num_frames = 0;
    bool had_people = false;  // learned from pictures with people in the room

    std::vector<std::uint16_t> luma;       // mean, in 1/256
    std::vector<std::uint8_t> luma_sigma;  // in 1/4, rounded up
    std::vector<std::int16_t> u;           // mean of U - 128, in 1/128
    std::vector<std::int16_t> v;
    std::vector<std::int16_t> uu;  // covariance, in 1/16
    std::vector<std::int16_t> uv;
    std::vector<std::int16_t> vv;
};

/// Blocks per group: as many pixels of a row as fit the widest registers.
constexpr int kBlocksPerGroup = 16;
constexpr int kPixelsPerGroup = 2 * kBlocksPerGroup;

/// Thresholds and ratios of 16 adjacent blocks. The test reads these for the whole picture,
/// therefore they are contiguous: three cache lines. Blocks right of the picture are never
/// foreground.
struct alignas(64) RoomLook {
    RoomLook() {
        for (auto& row : luma_high) row.fill(255);
    }
    bool operator==(const RoomLook&) const = default;

    // per pixel of both rows: luma outside [luma_low, luma_high] is foreground at any colour
    std::array<std::array<std::uint8_t, kPixelsPerGroup>, 2> luma_low{};
    std::array<std::array<std::uint8_t, kPixelsPerGroup>, 2> luma_high;
    // expected chroma is ratio * luma; a shadow on the same surface keeps the ratio
    std::array<std::int16_t, kBlocksPerGroup> ratio_u{};  // (mean U - 128) / (mean Y), in 1/4096
    std::array<std::int16_t, kBlocksPerGroup> ratio_v{};
};

/// Whitening of the same blocks: (du, dv) -> (whiten_u du, whiten_uv du + whiten_v dv) has unit
/// covariance; in 1/32768. All 0 where the room is too dark to have a colour. Rarely read.
struct HueNoise {
    std::array<std::int16_t, kBlocksPerGroup> whiten_u{};
    std::array<std::int16_t, kBlocksPerGroup> whiten_uv{};
    std::array<std::int16_t, kBlocksPerGroup> whiten_v{};
};

/// The background as integers for the per-pixel test, under given options.
///
/// `luma`, `u` and `v` start as those of `room`. When the light drifts they move away from it by a
/// bounded amount (light_adaptation.hpp).
struct BackgroundModel {
    BackgroundStatistics room;
    std::vector<std::uint16_t> luma;  // current values, in the units of `room`
    std::vector<std::int16_t> u;
    std::vector<std::int16_t> v;

    // per block
    std::vector<std::uint8_t> darkest;  // fraction of luma that remains in shadow, in 1/256
    // per group of blocks, row by row
    std::vector<RoomLook> looks;
    std::vector<HueNoise> hue_noise;

    // per row of blocks: where du^2 + dv^2, in 1/16, is at most this, every block of the row has
    // the room's hue; set by limit_near_hues
    std::vector<std::int32_t> near_hue_sq;

    std::int32_t max_distance_sq = 0;  // of whitened chroma, in 1/4096
    std::int16_t min_colour_luma = 0;  // with a smaller sum of four lumas, chroma is ignored
    // from options, in the units of update_light
    std::int32_t luma_distance = 0;   // in 1/64 of a deviation
    std::int32_t min_luma_noise = 0;  // in 1/256
    std::int32_t highlight = 0;       // 1 + the fraction, in 1/256

    /// Of OutlineRefinement: factor on the squared distance to a person's colour, in 1/8.
    std::int32_t person_factor = 8;

    int width() const { return room.width; }
    int height() const { return room.height; }
    int groups_per_row() const { return (room.width + kPixelsPerGroup - 1) / kPixelsPerGroup; }
    /// Index of a block row's first group in `looks` and `hue_noise`.
    std::size_t first_group(int block_row) const {
        return static_cast<std::size_t>(block_row) * static_cast<std::size_t>(groups_per_row());
    }
    /// Resizes both to the size of the room.
    void resize_groups() {
        const std::size_t num = first_group(room.height / 2);
        looks.assign(num, {});
        hue_noise.assign(num, {});
    }
};

/// Samples from here on may be clipped: brighter light looks the same, and a clipped channel
/// falsifies the colour.
constexpr std::uint8_t kClipped = 250;

/// Builds the model. The vector sizes of `statistics` must agree (BackgroundLearner and
/// load_background guarantee it).
BackgroundModel make_model(BackgroundStatistics statistics, const SegmentationOptions& options);

/// Computes `near_hue_sq` from the whitening and `max_distance_sq`.
void limit_near_hues(BackgroundModel& model);

/// Computes thresholds and ratios of `part` from the model's luma, u and v. `part` must have even
/// coordinates and sizes. All instruction sets give the same bits.
void update_light(BackgroundModel& model,
                  const image::PixelRect& part,
                  InstructionSet instructions = best_instruction_set());

/// Learns the background from pictures of the empty room.
class BackgroundLearner {
public:
    /// Adds a picture. All must have one even, non-zero size and one mosaic; the first sets both.
    Expected<void> add(const image::YuvView& frame);

    /// Returns an error without any picture. One picture is enough: its noise is then the lower
    /// limit of the options.
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
