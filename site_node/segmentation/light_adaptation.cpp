#include "site_node/segmentation/light_adaptation.hpp"

#include "site_node/segmentation/pixel_test.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace atrium::segmentation {
namespace {

constexpr int kCell = LightAdaptation::kCell;
// This many places give the median within a tenth of a percent.
constexpr int kMaxSamples = 300;
constexpr int kMinSamples = 48;
// Ratios to a smaller luma are too coarse.
constexpr std::int32_t kMinGainLuma = 32;
constexpr std::int32_t kDeadband = kUnitGain / 200;
// Largest difference by which one visit moves chroma [1/128 grey level]; a larger difference is not
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

// Adjacent blocks in the picture and in the model, from the first on.
struct FollowedRow {
    const std::uint8_t* top;
    const std::uint8_t* bottom;
    const std::uint8_t* u;
    const std::uint8_t* v;
    std::size_t pixel;  // of the upper row, in the model
    std::size_t block;
    std::size_t num_blocks;
};

struct Drift {
    std::int32_t inverse_gain;
    std::int32_t share;     // of the difference that one visit removes, in 1/65536
    std::int32_t max_luma;  // in 1/256
};

// Plain C++ for the compiler to vectorise, instantiated once per instruction set.
#define ATRIUM_INLINE inline __attribute__((always_inline))

ATRIUM_INLINE std::int32_t toward(std::int32_t value, std::int32_t target, std::int32_t share) {
    return value + (((target - value) * share + (1 << 15)) >> 16);
}

// Marks the blocks that show background up to noise with 1, others with 0. Tests at the compensated
// brightness, but the model follows the uncompensated one: a lasting change becomes part of the
// model, and the gain returns to 1.
ATRIUM_INLINE void find_background(const FollowedRow& row,
                                   const Drift& drift,
                                   const BackgroundModel& model,
                                   std::uint8_t* __restrict is_background) {
    const std::uint8_t* __restrict top = row.top;
    const std::uint8_t* __restrict bottom = row.bottom;
    const std::uint16_t* __restrict top_mean = model.luma.data() + row.pixel;
    const std::uint16_t* __restrict bottom_mean = top_mean + model.width();
    const std::uint8_t* __restrict sigma = model.room.luma_sigma.data() + row.pixel;
    const std::int32_t luma_distance = model.luma_distance;
    const std::int32_t min_luma_noise = model.min_luma_noise;
    for (std::size_t i = 0; i < row.num_blocks; ++i) {
        const std::size_t left = 2 * i;
        const std::size_t right = left + 1;
        const std::int32_t frame_sum = top[left] + top[right] + bottom[left] + bottom[right];
        const std::int32_t model_sum =
            top_mean[left] + top_mean[right] + bottom_mean[left] + bottom_mean[right];
        const int brightest =
            std::max(std::max(top[left], top[right]), std::max(bottom[left], bottom[right]));
        const int brightest_mean = std::max(std::max(top_mean[left], top_mean[right]),
                                            std::max(bottom_mean[left], bottom_mean[right]));
        const std::int32_t compensated = frame_sum * drift.inverse_gain / (kUnitGain / 256);
        // the mean of four has half the noise of one
        const std::int32_t noise = 2 * std::max(sigma[left] * luma_distance, min_luma_noise);
        const bool is_near = std::abs(compensated - model_sum) <= noise;
        is_background[i] = static_cast<std::uint8_t>(is_near & (brightest < kClipped) &
                                                     (brightest_mean < kClipped * 256));
    }
}

// Moves one row of pixels; `moves` holds a flag per pixel, taken from its block.
ATRIUM_INLINE void follow_luma(const std::uint8_t* __restrict samples,
                               const std::uint8_t* __restrict moves,
                               std::size_t num,
                               const Drift& drift,
                               const std::uint16_t* __restrict learned,
                               std::uint16_t* __restrict luma) {
    for (std::size_t i = 0; i < num; ++i) {
        const std::int32_t lowest = learned[i] - drift.max_luma;
        const std::int32_t highest = learned[i] + drift.max_luma;
        const std::int32_t moved =
            std::min(std::max(toward(luma[i], samples[i] * 256, drift.share), lowest), highest);
        const std::int32_t kept = luma[i];
        luma[i] = static_cast<std::uint16_t>(moves[i] != 0 ? std::clamp(moved, 0, 0xffff) : kept);
    }
}

ATRIUM_INLINE void follow_chroma(const std::uint8_t* __restrict samples,
                                 const std::uint8_t* __restrict moves,
                                 std::size_t num,
                                 const Drift& drift,
                                 const std::int16_t* __restrict learned,
                                 std::int16_t* __restrict chroma) {
    // in 1/128, and half as far as luma: a quarter of the number
    const std::int32_t max_chroma = drift.max_luma / 4;
    for (std::size_t i = 0; i < num; ++i) {
        const std::int32_t value = chroma[i];
        const std::int32_t target = (samples[i] - 128) * 128;
        const std::int32_t near =
            std::min(std::max(target, value - kMaxChromaStep), value + kMaxChromaStep);
        const std::int32_t lowest = learned[i] - max_chroma;
        const std::int32_t highest = learned[i] + max_chroma;
        const std::int32_t moved =
            std::min(std::max(toward(value, near, drift.share), lowest), highest);
        chroma[i] =
            static_cast<std::int16_t>(moves[i] != 0 ? std::clamp(moved, -0x7fff, 0x7fff) : value);
    }
}

ATRIUM_INLINE void follow_row(const FollowedRow& whole,
                              const Drift& drift,
                              BackgroundModel& model) {
    constexpr std::size_t kChunk = 64;  // blocks
    std::array<std::uint8_t, kChunk> moves;
    std::array<std::uint8_t, 2 * kChunk> moves_of_pixels;
    const auto width = static_cast<std::size_t>(model.width());
    for (std::size_t first = 0; first < whole.num_blocks; first += kChunk) {
        const std::size_t num = std::min(kChunk, whole.num_blocks - first);
        const FollowedRow row{whole.top + 2 * first,
                              whole.bottom + 2 * first,
                              whole.u + first,
                              whole.v + first,
                              whole.pixel + 2 * first,
                              whole.block + first,
                              num};
        find_background(row, drift, model, moves.data());
        for (std::size_t i = 0; i < num; ++i)
            moves_of_pixels[2 * i] = moves_of_pixels[2 * i + 1] = moves[i];
        for (const auto& [samples, pixel] :
             {std::pair{row.top, row.pixel}, {row.bottom, row.pixel + width}}) {
            follow_luma(samples,
                        moves_of_pixels.data(),
                        2 * num,
                        drift,
                        model.room.luma.data() + pixel,
                        model.luma.data() + pixel);
        }
        follow_chroma(row.u,
                      moves.data(),
                      num,
                      drift,
                      model.room.u.data() + row.block,
                      model.u.data() + row.block);
        follow_chroma(row.v,
                      moves.data(),
                      num,
                      drift,
                      model.room.v.data() + row.block,
                      model.v.data() + row.block);
    }
}

void follow_row_baseline(const FollowedRow& row, const Drift& drift, BackgroundModel& model) {
    follow_row(row, drift, model);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void follow_row_avx2(const FollowedRow& row,
                                                     const Drift& drift,
                                                     BackgroundModel& model) {
    follow_row(row, drift, model);
}
#endif

#undef ATRIUM_INLINE

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

// Looks at every eighth row: flatter parts of people are near others.
void LightAdaptation::find_people(const image::SparseMask& people) {
    const image::Mask& mask = people.mask;
    cells_x_ = (mask.width + kCell - 1) / kCell;
    cells_y_ = (mask.height + kCell - 1) / kCell;
    const auto num_cells = static_cast<std::size_t>(cells_x_) * static_cast<std::size_t>(cells_y_);
    has_people_.assign(num_cells, 0);
    near_people_.assign(num_cells, 0);
    for (int y = 0; y < mask.height; y += 8) {
        const std::uint8_t* row = mask.row(y);
        std::uint8_t* cells =
            has_people_.data() + static_cast<std::ptrdiff_t>(y / kCell) * cells_x_;
        const image::PixelSpan span = people.rows[static_cast<std::size_t>(y)];
        const int end_cell = std::min((span.end + kCell - 1) / kCell, mask.width / kCell);
        for (int cell = span.begin / kCell; cell < end_cell; ++cell) {
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

// `part` has even coordinates and sizes, and nobody is near it.
void LightAdaptation::follow_part(const image::YuvView& frame,
                                  const image::PixelRect& part,
                                  const Follow& how,
                                  BackgroundModel& model) const {
    auto* follow_blocks = follow_row_baseline;
#if defined(__x86_64__)
    if (how.instructions == InstructionSet::kAvx2) follow_blocks = follow_row_avx2;
#endif
    const auto width = static_cast<std::size_t>(model.width());
    const auto x = static_cast<std::size_t>(part.x);
    for (int y = part.y; y < part.y + part.height; y += 2) {
        const auto block_row = static_cast<std::size_t>(y / 2);
        const FollowedRow row{frame.y.row(y) + x,
                              frame.y.row(y + 1) + x,
                              frame.u.row(y / 2) + x / 2,
                              frame.v.row(y / 2) + x / 2,
                              2 * block_row * width + x,
                              block_row * (width / 2) + x / 2,
                              static_cast<std::size_t>(part.width / 2)};
        follow_blocks(row, {inverse_gain_, how.share, how.max_drift}, model);
    }
    update_light(model, part, how.instructions);
}

void LightAdaptation::follow(image::WorkingPicture& picture,
                             const image::SparseMask& mask,
                             const SegmentationOptions& options,
                             BackgroundModel& model,
                             InstructionSet instructions) {
    const bool drifts = options.drift_frames > 0.0;
    if (!drifts && options.max_gain_change <= 0.0) return;
    find_people(mask);
    if (!drifts) return;
    const int num_strips = (model.height() + kStrip - 1) / kStrip;
    const Follow how{static_cast<std::int32_t>(
                         std::lround(65536.0 * std::min(0.5, num_strips / options.drift_frames))),
                     static_cast<std::int32_t>(std::lround(256.0 * options.max_drift)),
                     instructions};
    next_strip_ = next_strip_ % num_strips;
    const int first_row = next_strip_ * kStrip;
    const int num_rows = std::min(kStrip, model.height() - first_row);
    picture.make({0, first_row, model.width(), num_rows});
    for (int cell = 0; cell < cells_x_;) {
        const int first = cell;
        while (cell < cells_x_ && !is_near_people(cell, first_row / kCell)) ++cell;
        const int x = first * kCell;
        const int end = std::min(cell * kCell, model.width());
        if (x < end) follow_part(picture.view(), {x, first_row, end - x, num_rows}, how, model);
        while (cell < cells_x_ && is_near_people(cell, first_row / kCell)) ++cell;
    }
    ++next_strip_;
}

}  // namespace atrium::segmentation
