#include "site_node/segmentation/background_model.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::segmentation {
namespace {

// Near the clipping one channel may clip before the others: chroma is worth less.
constexpr double kBrightLuma = 225.0;
constexpr double kBrightSigmaFactor = 3.0;
// A ratio of chroma to less luma than this would be noise.
constexpr double kMinRatioLuma = 24.0;
// A hue tells a dark thing from a shadow where it is so many times as far as the threshold: things
// are not quite colourless, and codecs smear hues.
constexpr double kSureFactor = 2.5;
constexpr std::int32_t kClippedMean = kClipped * 256;

std::int16_t fixed_point(double value, double one) {
    return static_cast<std::int16_t>(std::clamp(std::round(value * one), -32767.0, 32767.0));
}

std::uint8_t part_of_256(double part) {
    return static_cast<std::uint8_t>(std::clamp(std::round(256.0 * part), 0.0, 255.0));
}

struct BlockLuma {
    double mean = 0.0;
    bool may_clip = false;  // any of the four
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

// The inverse Cholesky factor of the covariance, and how dark a shadow may be.
void set_chroma_noise(const SegmentationOptions& options,
                      std::size_t block,
                      BackgroundModel& model) {
    const BackgroundStatistics& room = model.room;
    const BlockLuma luma = luma_of_block(room, block);
    const double darkest = options.darkest_shadow;
    model.darkest[block] = part_of_256(darkest);
    if (luma.mean < options.dark_luma) return;  // whitening stays 0: chroma does not vote

    // the floor is added, not only a bound: it is a further, independent source of noise
    const bool unsure = luma.may_clip || luma.mean >= kBrightLuma;
    const double sigma = (unsure ? kBrightSigmaFactor : 1.0) * options.min_chroma_sigma;
    const double floor = sigma * sigma;
    const double uv = room.uv[block] / 16.0;
    const double l11 = std::sqrt(std::max(room.uu[block] / 16.0, 0.0) + floor);
    const double l21 = uv / l11;
    const double l22 =
        std::sqrt(std::max(std::max(room.vv[block] / 16.0, 0.0) + floor - l21 * l21, floor));
    model.whiten_u[block] = fixed_point(1.0 / l11, 32768.0);
    model.whiten_v[block] = fixed_point(1.0 / l22, 32768.0);
    model.whiten_uv[block] = fixed_point(-l21 / (l11 * l22), 32768.0);

    // How far a colourless thing is from the room's hue; in a shadow of a part of the luma, that
    // part of it. Where it is still well beyond the threshold, a dark thing is told by its hue.
    const double u = room.u[block] / 128.0;
    const double v = room.v[block] / 128.0;
    const double colour = std::hypot(u / l11, (v - l21 / l11 * u) / l22);
    if (unsure || colour <= 0.0) return;
    const double told_from = kSureFactor * options.max_chroma_distance / colour;
    const double lowest = std::min(options.darkest_coloured_shadow, darkest);
    model.darkest[block] = part_of_256(std::clamp(told_from, lowest, darkest));
}

}  // namespace

void update_light(BackgroundModel& model, int first_row, int end_row) {
    const auto width = static_cast<std::size_t>(model.width());
    const std::size_t num_blocks = width / 2;
    for (auto y = static_cast<std::size_t>(first_row); y < static_cast<std::size_t>(end_row); ++y) {
        const std::uint8_t* darkest = model.darkest.data() + y / 2 * num_blocks;
        for (std::size_t x = 0; x < width; ++x) {
            const std::size_t pixel = y * width + x;
            const std::int32_t mean = model.luma[pixel];
            const std::int32_t noise = luma_noise(model, pixel);
            const std::int32_t low = std::min((mean * darkest[x / 2]) >> 8, mean - noise);
            const std::int32_t high = ((mean * model.highlight) >> 8) + noise;
            model.luma_low[pixel] = static_cast<std::uint8_t>(std::clamp((low + 128) >> 8, 0, 255));
            model.luma_high[pixel] = static_cast<std::uint8_t>(
                mean >= kClippedMean ? 255 : std::clamp((high + 128) >> 8, 0, 255));
        }
    }
    for (auto row = static_cast<std::size_t>(first_row / 2);
         row < static_cast<std::size_t>(end_row / 2);
         ++row) {
        const std::uint16_t* top = model.luma.data() + 2 * row * width;
        const std::uint16_t* bottom = top + width;
        for (std::size_t x = 0; x < num_blocks; ++x) {
            const std::size_t block = row * num_blocks + x;
            const int sum = top[2 * x] + top[2 * x + 1] + bottom[2 * x] + bottom[2 * x + 1];
            const float luma =
                std::max(static_cast<float>(sum), static_cast<float>(1024.0 * kMinRatioLuma));
            // 1/128 over 1/1024, in 1/4096; chroma is less than twice the luma in any real colour
            const float scale = 32768.0F / luma;
            const auto ratio = [&](std::int16_t chroma) {
                return static_cast<std::int16_t>(
                    std::clamp(static_cast<float>(chroma) * scale, -8192.0F, 8192.0F));
            };
            model.ratio_u[block] = ratio(model.u[block]);
            model.ratio_v[block] = ratio(model.v[block]);
        }
    }
}

BackgroundModel make_model(BackgroundStatistics statistics, const SegmentationOptions& options) {
    BackgroundModel model;
    model.room = std::move(statistics);
    model.luma = model.room.luma;
    model.u = model.room.u;
    model.v = model.room.v;
    model.luma_low.resize(model.luma.size());
    model.luma_high.resize(model.luma.size());
    model.darkest.resize(model.u.size());
    for (auto* plane :
         {&model.ratio_u, &model.ratio_v, &model.whiten_u, &model.whiten_uv, &model.whiten_v})
        plane->assign(model.u.size(), 0);
    model.max_distance_sq = static_cast<std::int32_t>(
        std::lround(4096.0 * options.max_chroma_distance * options.max_chroma_distance));
    model.min_colour_luma = fixed_point(options.dark_luma, 4.0);
    // a deviation is in quarters
    model.luma_distance = static_cast<std::int32_t>(std::lround(64.0 * options.max_luma_distance));
    model.min_luma_noise = static_cast<std::int32_t>(
        std::lround(256.0 * options.max_luma_distance * options.min_luma_sigma));
    model.highlight = static_cast<std::int32_t>(std::lround(256.0 * (1.0 + options.max_highlight)));
    for (std::size_t block = 0; block < model.u.size(); ++block)
        set_chroma_noise(options, block, model);
    update_light(model, 0, model.height());
    return model;
}

}  // namespace atrium::segmentation
