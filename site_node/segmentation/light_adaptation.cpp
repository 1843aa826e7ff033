#include "site_node/segmentation/light_adaptation.hpp"

#include "site_node/segmentation/pixel_test.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace atrium::segmentation {
namespace {

constexpr int kCell = LightAdaptation::kCell;
// So many places give the median within a tenth of a percent.
constexpr int kMaxSamples = 300;
constexpr int kMinSamples = 48;
// Ratios of less luma than this are coarse.
constexpr std::int32_t kMinGainLuma = 32;
constexpr std::int32_t kDeadband = kUnitGain / 200;
// One visit moves chroma as if it differed by so many grey levels at most: what differs more is no
// drift.
constexpr std::int32_t kMaxChromaStep = 4 * 128;

struct Block {
    std::int32_t frame_sum = 0;
    std::int32_t model_sum = 0;  // in 1/256
    bool clipped = false;
};

Block block_at(const image::YuvView& frame, const BackgroundModel& model, int x, int y) {
    Block block;
    for (int line = y; line < y + 2; ++line) {
        const std::uint8_t* samples = frame.y.row(line) + x;
        const std::uint16_t* means =
            model.luma.data() + static_cast<std::ptrdiff_t>(line) * model.width() + x;
        block.frame_sum += samples[0] + samples[1];
        block.model_sum += means[0] + means[1];
        block.clipped = block.clipped || std::max(samples[0], samples[1]) >= kClipped ||
                        std::max(means[0], means[1]) >= kClipped * 256;
    }
    return block;
}

std::int32_t toward(std::int32_t value, std::int32_t target, std::int32_t share) {
    return value + (((target - value) * share + (1 << 15)) >> 16);
}

}  // namespace

std::int16_t LightAdaptation::inverse_gain(image::WorkingPicture& picture,
                                           const BackgroundModel& model,
                                           const SegmentationOptions& options) {
    if (options.max_gain_change <= 0.0) return kUnitGain;
    const int cells_x = model.width() / kCell;
    const int cells_y = model.height() / kCell;
    const int step = std::max(1, cells_x * cells_y / kMaxSamples);
    samples_.clear();
    for (int cell = 0; cell < cells_x * cells_y; cell += step) {
        const int cell_x = cell % cells_x;
        const int cell_y = cell / cells_x;
        if (is_near_people(cell_x, cell_y)) continue;
        const int x = cell_x * kCell + kCell / 2;
        const int y = cell_y * kCell + kCell / 2;
        picture.make({x, y, 2, 2});
        const Block block = block_at(picture.view(), model, x, y);
        if (block.clipped || block.frame_sum < 2 * kMinGainLuma ||
            block.model_sum < 4 * 256 * kMinGainLuma)
            continue;
        samples_.push_back(block.model_sum * (kUnitGain / 256) / block.frame_sum);
    }
    const auto num_cells = static_cast<std::size_t>(cells_x * cells_y / step);
    if (samples_.size() < kMinSamples || samples_.size() < num_cells / 8) return inverse_gain_;
    const auto middle = samples_.begin() + static_cast<std::ptrdiff_t>(samples_.size() / 2);
    std::nth_element(samples_.begin(), middle, samples_.end());
    const double change = options.max_gain_change;
    const std::int32_t bounded = std::clamp(
        *middle,
        static_cast<std::int32_t>(std::lround(kUnitGain / (1.0 + change))),
        static_cast<std::int32_t>(std::min(std::lround(kUnitGain / (1.0 - change)), 32767L)));
    inverse_gain_ =
        static_cast<std::int16_t>(std::abs(bounded - kUnitGain) < kDeadband ? kUnitGain : bounded);
    return inverse_gain_;
}

// Every eighth row is looked at: flatter parts are near others.
void LightAdaptation::find_people(const image::Mask& mask) {
    cells_x_ = (mask.width + kCell - 1) / kCell;
    cells_y_ = (mask.height + kCell - 1) / kCell;
    const auto num_cells = static_cast<std::size_t>(cells_x_) * static_cast<std::size_t>(cells_y_);
    has_people_.assign(num_cells, 0);
    near_people_.assign(num_cells, 0);
    for (int y = 0; y < mask.height; y += 8) {
        const std::uint8_t* row = mask.row(y);
        std::uint8_t* cells =
            has_people_.data() + static_cast<std::ptrdiff_t>(y / kCell) * cells_x_;
        for (int cell = 0; cell < mask.width / kCell; ++cell) {
            std::uint64_t words[2];
            std::memcpy(words, row + cell * kCell, sizeof words);
            cells[cell] |= static_cast<std::uint8_t>((words[0] | words[1]) != 0 ? 1 : 0);
        }
        for (int x = mask.width / kCell * kCell; x < mask.width; ++x)
            cells[x / kCell] |= row[x] & 1;
    }
    for (int y = 0; y < cells_y_; ++y) {
        for (int x = 0; x < cells_x_; ++x) {
            if (has_people_[static_cast<std::size_t>(y * cells_x_ + x)] == 0) continue;
            for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, cells_y_ - 1); ++ny) {
                for (int nx = std::max(x - 1, 0); nx <= std::min(x + 1, cells_x_ - 1); ++nx)
                    near_people_[static_cast<std::size_t>(ny * cells_x_ + nx)] = 1;
            }
        }
    }
}

// Whether it is background is asked at the compensated brightness; where it goes is what the camera
// sees: what stays changed becomes part of the model, and the gain returns to 1.
void LightAdaptation::follow_block(const image::YuvView& frame,
                                   int x,
                                   int y,
                                   BackgroundModel& model) const {
    const Block block = block_at(frame, model, x, y);
    const auto first = static_cast<std::size_t>(y) * static_cast<std::size_t>(model.width()) +
                       static_cast<std::size_t>(x);
    const std::int32_t compensated = block.frame_sum * inverse_gain_ / (kUnitGain / 256);
    // the mean of four has half the noise of one
    if (block.clipped || std::abs(compensated - block.model_sum) > 2 * luma_noise(model, first))
        return;
    for (int line = y; line < y + 2; ++line) {
        const std::uint8_t* samples = frame.y.row(line) + x;
        const std::size_t at = first + (line == y ? 0 : static_cast<std::size_t>(model.width()));
        for (std::size_t i = 0; i < 2; ++i) {
            const std::int32_t learned = model.room.luma[at + i];
            const std::int32_t moved =
                std::clamp(toward(model.luma[at + i], samples[i] * 256, share_),
                           learned - max_drift_,
                           learned + max_drift_);
            model.luma[at + i] = static_cast<std::uint16_t>(std::clamp(moved, 0, 0xffff));
        }
    }
    const std::size_t b =
        static_cast<std::size_t>(y / 2) * static_cast<std::size_t>(model.width() / 2) +
        static_cast<std::size_t>(x / 2);
    const auto follow_chroma = [&](std::int16_t learned, std::uint8_t sample, std::int16_t& value) {
        const std::int32_t target = (sample - 128) * 128;
        const std::int32_t near =
            std::clamp(target, value - kMaxChromaStep, value + kMaxChromaStep);
        // in 1/128, and half as far: a quarter of the number
        const std::int32_t moved = std::clamp(
            toward(value, near, share_), learned - max_drift_ / 4, learned + max_drift_ / 4);
        value = static_cast<std::int16_t>(std::clamp(moved, -0x7fff, 0x7fff));
    };
    follow_chroma(model.room.u[b], frame.u.at(x / 2, y / 2), model.u[b]);
    follow_chroma(model.room.v[b], frame.v.at(x / 2, y / 2), model.v[b]);
}

void LightAdaptation::follow(const image::YuvView& frame,
                             const image::Mask& mask,
                             const SegmentationOptions& options,
                             BackgroundModel& model) {
    const bool drifts = options.drift_frames > 0.0;
    if (!drifts && options.max_gain_change <= 0.0) return;
    find_people(mask);
    if (!drifts) return;
    const int num_strips = (model.height() + kStrip - 1) / kStrip;
    share_ = static_cast<std::int32_t>(
        std::lround(65536.0 * std::min(0.5, num_strips / options.drift_frames)));
    max_drift_ = static_cast<std::int32_t>(std::lround(256.0 * options.max_drift));
    next_strip_ = next_strip_ % num_strips;
    const int first_row = next_strip_ * kStrip;
    const int end_row = std::min(first_row + kStrip, model.height());
    for (int y = first_row; y < end_row; y += 2) {
        for (int x = 0; x < model.width(); x += 2) {
            if (!is_near_people(x / kCell, first_row / kCell)) follow_block(frame, x, y, model);
        }
    }
    update_light(model, first_row, end_row);
    ++next_strip_;
}

}  // namespace atrium::segmentation
