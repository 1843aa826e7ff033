#include "site_node/segmentation/background_model.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace atrium::segmentation {
namespace {

// Darker blocks have no meaningful ratio of chroma to luma; they are treated as if they were this
// bright.
constexpr double kMinRatioLuma = 24.0;
// From here on a sensor clips: what is brighter still looks the same, and the true mean may be
// higher.
constexpr double kClippedLuma = 250.0;
// Near there, one channel may clip before the others: chroma is worth less.
constexpr double kBrightLuma = 225.0;
constexpr double kBrightSigmaFactor = 3.0;

std::int16_t fixed_point(double value, double one) {
    return static_cast<std::int16_t>(std::clamp(std::round(value * one), -32767.0, 32767.0));
}

std::uint8_t byte(double value) {
    return static_cast<std::uint8_t>(std::clamp(std::round(value), 0.0, 255.0));
}

struct ChromaStatistics {
    double luma = 0.0;
    double u = 0.0;
    double v = 0.0;
    double uu = 0.0;
    double uv = 0.0;
    double vv = 0.0;
};

// Writes ratio and the inverse Cholesky factor of the covariance.
void set_block(const ChromaStatistics& s,
               double min_sigma,
               std::size_t block,
               BackgroundModel& model) {
    const double luma = std::max(s.luma, kMinRatioLuma);
    model.ratio_u[block] = fixed_point(std::clamp(s.u / luma, -2.0, 2.0), 4096.0);
    model.ratio_v[block] = fixed_point(std::clamp(s.v / luma, -2.0, 2.0), 4096.0);
    // the floor is added, not only a bound: it is a further, independent source of noise
    const double sigma = s.luma >= kBrightLuma ? kBrightSigmaFactor * min_sigma : min_sigma;
    const double floor = sigma * sigma;
    const double l11 = std::sqrt(s.uu + floor);
    const double l21 = s.uv / l11;
    const double l22 = std::sqrt(std::max(s.vv + floor - l21 * l21, floor));
    model.whiten_u[block] = fixed_point(1.0 / l11, 32768.0);
    model.whiten_v[block] = fixed_point(1.0 / l22, 32768.0);
    model.whiten_uv[block] = fixed_point(-l21 / (l11 * l22), 32768.0);
}

void set_luma(double mean,
              double variance,
              const SegmentationOptions& options,
              std::size_t pixel,
              BackgroundModel& model) {
    const double sigma = std::max(std::sqrt(std::max(variance, 0.0)), options.min_luma_sigma);
    const double noise = options.max_luma_distance * sigma;
    const double low = std::min(mean * options.darkest_shadow, mean - noise);
    const double high = mean * (1.0 + options.max_highlight) + noise;
    model.luma_low[pixel] = byte(low);
    model.luma_high[pixel] = mean >= kClippedLuma ? 255 : byte(high);
}

}  // namespace

Expected<void> BackgroundLearner::add(const image::YuvView& frame) {
    const int width = frame.width();
    const int height = frame.height();
    if (width <= 0 || height <= 0 || width % 2 != 0 || height % 2 != 0 ||
        frame.u.width != width / 2 || frame.u.height != height / 2 || frame.v.width != width / 2 ||
        frame.v.height != height / 2) {
        return make_error(ErrorKind::kInvalidData,
                          "background picture of " + std::to_string(width) + "x" +
                              std::to_string(height) + " is not a 4:2:0 picture of even size");
    }
    if (num_frames_ == 0) {
        width_ = width;
        height_ = height;
        const auto num_pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
        sum_y_.assign(num_pixels, 0);
        sum_yy_.assign(num_pixels, 0);
        for (auto* sums : {&sum_u_, &sum_v_, &sum_uu_, &sum_uv_, &sum_vv_})
            sums->assign(num_pixels / 4, 0.0F);
    } else if (width != width_ || height != height_) {
        return make_error(ErrorKind::kInvalidData,
                          "background pictures differ in size: first " + std::to_string(width_) +
                              "x" + std::to_string(height_) + ", then " + std::to_string(width) +
                              "x" + std::to_string(height));
    }
    // 32 bits hold the squares of 66,000 frames: 36 minutes at 30 Hz
    constexpr int kMaxFrames = 60000;
    if (num_frames_ == kMaxFrames) {
        return make_error(ErrorKind::kInvalidData,
                          "more than " + std::to_string(kMaxFrames) + " background pictures");
    }
    ++num_frames_;
    std::size_t i = 0;
    for (int row = 0; row < height; ++row) {
        const std::uint8_t* samples = frame.y.row(row);
        for (int x = 0; x < width; ++x, ++i) {
            const std::uint32_t y = samples[x];
            sum_y_[i] += y;
            sum_yy_[i] += y * y;
        }
    }
    i = 0;
    for (int row = 0; row < height / 2; ++row) {
        for (int x = 0; x < width / 2; ++x, ++i) {
            const float u = static_cast<float>(frame.u.at(x, row)) - 128.0F;
            const float v = static_cast<float>(frame.v.at(x, row)) - 128.0F;
            sum_u_[i] += u;
            sum_v_[i] += v;
            sum_uu_[i] += u * u;
            sum_uv_[i] += u * v;
            sum_vv_[i] += v * v;
        }
    }
    return {};
}

Expected<BackgroundModel> BackgroundLearner::finish(const SegmentationOptions& options) const {
    if (num_frames_ == 0) return make_error(ErrorKind::kNotFound, "no picture of the empty room");
    BackgroundModel model;
    model.width = width_;
    model.height = height_;
    model.luma_low.resize(sum_y_.size());
    model.luma_high.resize(sum_y_.size());
    for (auto* plane :
         {&model.ratio_u, &model.ratio_v, &model.whiten_u, &model.whiten_uv, &model.whiten_v}) {
        plane->resize(sum_u_.size());
    }
    const double scale = 1.0 / num_frames_;
    for (std::size_t i = 0; i < sum_y_.size(); ++i) {
        const double mean = scale * sum_y_[i];
        set_luma(mean, scale * sum_yy_[i] - mean * mean, options, i, model);
    }
    const auto width = static_cast<std::size_t>(width_);
    for (std::size_t i = 0; i < sum_u_.size(); ++i) {
        const std::size_t top = i / (width / 2) * 2 * width + i % (width / 2) * 2;
        ChromaStatistics s;
        s.luma = 0.25 * scale *
                 (static_cast<double>(sum_y_[top]) + sum_y_[top + 1] + sum_y_[top + width] +
                  sum_y_[top + width + 1]);
        s.u = scale * sum_u_[i];
        s.v = scale * sum_v_[i];
        s.uu = scale * sum_uu_[i] - s.u * s.u;
        s.uv = scale * sum_uv_[i] - s.u * s.v;
        s.vv = scale * sum_vv_[i] - s.v * s.v;
        // a float sum of many frames may leave a little less than zero
        s.uu = std::max(s.uu, 0.0);
        s.vv = std::max(s.vv, 0.0);
        set_block(s, options.min_chroma_sigma, i, model);
    }
    model.max_distance_sq = static_cast<std::int32_t>(
        std::lround(4096.0 * options.max_chroma_distance * options.max_chroma_distance));
    return model;
}

}  // namespace atrium::segmentation
