#include "site_node/segmentation/background_model.hpp"

#include "site_node/segmentation/edge_width.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace atrium::segmentation {
namespace {

// Near clipping, one channel may clip before the others: chroma is less reliable.
constexpr double kBrightLuma = 225.0;
constexpr double kBrightSigmaFactor = 3.0;
// A ratio of chroma to a luma below this is noise.
constexpr double kMinRatioLuma = 24.0;
// Factor on the chroma threshold above which a hue distinguishes a dark object from a shadow. Real
// objects are not quite colourless, and codecs smear hues.
constexpr double kSureFactor = 2.5;
constexpr std::int32_t kClippedMean = kClipped * 256;

std::int16_t fixed_point(double value, double one) {
    return static_cast<std::int16_t>(std::clamp(std::round(value * one), -32767.0, 32767.0));
}

// In a sharp picture only one pixel at an outline is a mixture of two colours; what is darker than
// the person beside it is the person's rim. In a blurred one the mixture decides.
constexpr double kSharp_px = 1.1;
constexpr double kBlurred_px = 1.4;
constexpr double kSharpFactor = 5.0;  // in 1/8
constexpr double kBlurredFactor = 8.0;
constexpr std::int32_t kUnknownFactor = 6;

std::int32_t person_factor_of(const BackgroundStatistics& room) {
    const auto width_px = edge_width_px(room);
    if (!width_px) return kUnknownFactor;
    const double blur = std::clamp((*width_px - kSharp_px) / (kBlurred_px - kSharp_px), 0.0, 1.0);
    return static_cast<std::int32_t>(
        std::lround(kSharpFactor + blur * (kBlurredFactor - kSharpFactor)));
}

std::uint8_t part_of_256(double part) {
    return static_cast<std::uint8_t>(std::clamp(std::round(256.0 * part), 0.0, 255.0));
}

struct BlockLuma {
    double mean = 0.0;
    bool may_clip = false;  // any of the four pixels
};

BlockLuma luma_of_block(const BackgroundStatistics& room, std::size_t block) {
    const auto width = static_cast<std::size_t>(room.width);
    const std::size_t top = block / (width / 2) * 2 * width + block % (width / 2) * 2;
    BlockLuma luma;
    for (const std::size_t pixel : {top, top + 1, top + width, top + width + 1}) {
        luma.mean += room.luma[pixel] / 1024.0;
        luma.may_clip = luma.may_clip || room.luma[pixel] >= kClippedMean;
    }
    return luma;
}

// Sets the inverse Cholesky factor of the covariance, and how dark a shadow may be.
void set_chroma_noise(const SegmentationOptions& options,
                      std::size_t block,
                      BackgroundModel& model) {
    const BackgroundStatistics& room = model.room;
    const BlockLuma luma = luma_of_block(room, block);
    const double darkest = options.darkest_shadow;
    model.darkest[block] = part_of_256(darkest);
    if (luma.mean < options.dark_luma) return;  // whitening stays 0: chroma is ignored

    // the floor is added, not a lower bound: it is an independent source of noise
    const bool unsure = luma.may_clip || luma.mean >= kBrightLuma;
    const double sigma = (unsure ? kBrightSigmaFactor : 1.0) * options.min_chroma_sigma;
    const double floor = sigma * sigma;
    const double uv = room.uv[block] / 16.0;
    const double l11 = std::sqrt(std::max(room.uu[block] / 16.0, 0.0) + floor);
    const double l21 = uv / l11;
    const double l22 =
        std::sqrt(std::max(std::max(room.vv[block] / 16.0, 0.0) + floor - l21 * l21, floor));
    const std::size_t column = block % static_cast<std::size_t>(room.width / 2);
    const int row = static_cast<int>(block / static_cast<std::size_t>(room.width / 2));
    HueNoise& noise = model.hue_noise[model.first_group(row) + column / kBlocksPerGroup];
    const std::size_t at = column % kBlocksPerGroup;
    noise.whiten_u[at] = fixed_point(1.0 / l11, 32768.0);
    noise.whiten_v[at] = fixed_point(1.0 / l22, 32768.0);
    noise.whiten_uv[at] = fixed_point(-l21 / (l11 * l22), 32768.0);

    // Distance of a colourless object from the room's hue. In a shadow the distance shrinks with
    // the luma; while it stays well above the threshold, the hue identifies a dark object.
    const double u = room.u[block] / 128.0;
    const double v = room.v[block] / 128.0;
    const double colour = std::hypot(u / l11, (v - l21 / l11 * u) / l22);
    if (unsure || colour <= 0.0) return;
    const double shadow_limit = kSureFactor * options.max_chroma_distance / colour;
    const double lowest = std::min(options.darkest_coloured_shadow, darkest);
    model.darkest[block] = part_of_256(std::clamp(shadow_limit, lowest, darkest));
}

// Squared larger singular value of a block's whitening: the most by which it lengthens a vector.
double most_stretch_sq(const HueNoise& noise, std::size_t block) {
    const double u = noise.whiten_u[block] / 32768.0;
    const double uv = noise.whiten_uv[block] / 32768.0;
    const double v = noise.whiten_v[block] / 32768.0;
    const double sum = u * u + uv * uv + v * v;
    const double determinant = u * v;
    const double root = std::sqrt(std::max(sum * sum - 4.0 * determinant * determinant, 0.0));
    return 0.5 * (sum + root);
}

// Plain C++ for the compiler to vectorise, instantiated once per instruction set.
#define ATRIUM_INLINE inline __attribute__((always_inline))

// Sets the thresholds of `num` pixels of one row from `pixel` on; `darkest` is that of their
// blocks.
ATRIUM_INLINE void make_thresholds(const std::uint8_t* __restrict darkest,
                                   std::size_t pixel,
                                   std::size_t num,
                                   const BackgroundModel& model,
                                   std::uint8_t* __restrict luma_low,
                                   std::uint8_t* __restrict luma_high) {
    const std::uint16_t* __restrict luma = model.luma.data() + pixel;
    const std::uint8_t* __restrict sigma = model.room.luma_sigma.data() + pixel;
    const std::int32_t luma_distance = model.luma_distance;
    const std::int32_t min_luma_noise = model.min_luma_noise;
    const std::int32_t highlight = model.highlight;
    for (std::size_t i = 0; i < num; ++i) {
        const std::int32_t mean = luma[i];
        const std::int32_t noise = std::max(sigma[i] * luma_distance, min_luma_noise);
        const std::int32_t low = std::min((mean * darkest[i]) >> 8, mean - noise);
        const std::int32_t high = ((mean * highlight) >> 8) + noise;
        luma_low[i] = static_cast<std::uint8_t>(std::clamp((low + 128) >> 8, 0, 255));
        luma_high[i] = static_cast<std::uint8_t>(
            mean >= kClippedMean ? 255 : std::clamp((high + 128) >> 8, 0, 255));
    }
}

// Sets the ratios of `num` blocks, whose first pixels are `top` and `bottom`.
ATRIUM_INLINE void make_ratios(const std::uint16_t* __restrict top,
                               const std::uint16_t* __restrict bottom,
                               const std::int16_t* __restrict u,
                               const std::int16_t* __restrict v,
                               std::size_t num,
                               std::int16_t* __restrict ratio_u,
                               std::int16_t* __restrict ratio_v) {
    for (std::size_t i = 0; i < num; ++i) {
        const int sum = top[2 * i] + top[2 * i + 1] + bottom[2 * i] + bottom[2 * i + 1];
        const float luma =
            std::max(static_cast<float>(sum), static_cast<float>(1024.0 * kMinRatioLuma));
        // 1/128 over 1/1024, in 1/4096; real colours have a chroma below twice the luma
        const float scale = 32768.0F / luma;
        const auto ratio = [&](std::int16_t chroma) {
            return static_cast<std::int16_t>(static_cast<std::int32_t>(
                std::min(std::max(static_cast<float>(chroma) * scale, -8192.0F), 8192.0F)));
        };
        ratio_u[i] = ratio(u[i]);
        ratio_v[i] = ratio(v[i]);
    }
}

ATRIUM_INLINE void update_rows(BackgroundModel& model, const image::PixelRect& part) {
    const auto width = static_cast<std::size_t>(model.width());
    std::array<std::uint8_t, kPixelsPerGroup> darkest;
    for (int y = part.y; y < part.y + part.height; y += 2) {
        const int end = part.x + part.width;
        for (int x = part.x; x < end;) {
            const int first = x % kPixelsPerGroup;
            const int count = std::min(kPixelsPerGroup - first, end - x);
            const auto at = static_cast<std::size_t>(first);
            const auto num = static_cast<std::size_t>(count);
            const std::size_t pixel =
                static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
            const std::size_t block =
                static_cast<std::size_t>(y / 2) * (width / 2) + static_cast<std::size_t>(x / 2);
            RoomLook& look = model.looks[model.first_group(y / 2) +
                                         static_cast<std::size_t>(x / kPixelsPerGroup)];
            for (std::size_t i = 0; i < num / 2; ++i)
                darkest[2 * i] = darkest[2 * i + 1] = model.darkest[block + i];
            for (std::size_t line = 0; line < 2; ++line) {
                make_thresholds(darkest.data(),
                                pixel + line * width,
                                num,
                                model,
                                look.luma_low[line].data() + at,
                                look.luma_high[line].data() + at);
            }
            const std::uint16_t* const top = model.luma.data() + pixel;
            make_ratios(top,
                        top + width,
                        model.u.data() + block,
                        model.v.data() + block,
                        num / 2,
                        look.ratio_u.data() + at / 2,
                        look.ratio_v.data() + at / 2);
            x += count;
        }
    }
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void update_rows_avx2(BackgroundModel& model,
                                                      const image::PixelRect& part) {
    update_rows(model, part);
}
#endif

#undef ATRIUM_INLINE

}  // namespace

void update_light(BackgroundModel& model,
                  const image::PixelRect& part,
                  [[maybe_unused]] InstructionSet instructions) {
#if defined(__x86_64__)
    if (instructions == InstructionSet::kAvx2) return update_rows_avx2(model, part);
#endif
    update_rows(model, part);
}

void limit_near_hues(BackgroundModel& model) {
    // in 1/64: each product, one in `a` and two in `b`, is rounded by up to half a unit
    constexpr double kRounding = 1.2;
    constexpr double kQuarter = 16.0;
    const double most = std::max(std::sqrt(model.max_distance_sq) - kRounding, 0.0) / kQuarter;
    model.near_hue_sq.resize(static_cast<std::size_t>(model.height() / 2));
    for (std::size_t row = 0; row < model.near_hue_sq.size(); ++row) {
        double stretch_sq = 1e-6;
        const HueNoise* const noise =
            model.hue_noise.data() + model.first_group(static_cast<int>(row));
        for (int x = 0; x < model.width() / 2; ++x) {
            stretch_sq = std::max(stretch_sq,
                                  most_stretch_sq(noise[x / kBlocksPerGroup],
                                                  static_cast<std::size_t>(x % kBlocksPerGroup)));
        }
        model.near_hue_sq[row] = static_cast<std::int32_t>(
            std::min(std::floor(most * most / stretch_sq), 1.0 * (1 << 30)));
    }
}

BackgroundModel make_model(BackgroundStatistics statistics, const SegmentationOptions& options) {
    BackgroundModel model;
    model.room = std::move(statistics);
    model.luma = model.room.luma;
    model.u = model.room.u;
    model.v = model.room.v;
    model.darkest.resize(model.u.size());
    model.resize_groups();
    model.max_distance_sq = static_cast<std::int32_t>(
        std::lround(4096.0 * options.max_chroma_distance * options.max_chroma_distance));
    model.min_colour_luma = fixed_point(options.dark_luma, 4.0);
    // luma_sigma is in quarters
    model.luma_distance = static_cast<std::int32_t>(std::lround(64.0 * options.max_luma_distance));
    model.min_luma_noise = static_cast<std::int32_t>(
        std::lround(256.0 * options.max_luma_distance * options.min_luma_sigma));
    model.highlight = static_cast<std::int32_t>(std::lround(256.0 * (1.0 + options.max_highlight)));
    model.person_factor = person_factor_of(model.room);
    for (std::size_t block = 0; block < model.u.size(); ++block)
        set_chroma_noise(options, block, model);
    limit_near_hues(model);
    update_light(model, {0, 0, model.width(), model.height()});
    return model;
}

}  // namespace atrium::segmentation
