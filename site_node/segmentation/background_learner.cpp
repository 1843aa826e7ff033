#include "site_node/segmentation/background_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace atrium::segmentation {
namespace {

// The sums of squares of this many bytes fit 32 bits: half an hour at 30 Hz.
constexpr int kMaxFrames = 60000;

std::string size_text(int width, int height) {
    return std::to_string(width) + "x" + std::to_string(height);
}

template <typename Integer>
Integer rounded(double value) {
    return static_cast<Integer>(
        std::clamp(std::round(value),
                   static_cast<double>(std::numeric_limits<Integer>::min()),
                   static_cast<double>(std::numeric_limits<Integer>::max())));
}

}  // namespace

Expected<void> BackgroundLearner::start_or_check(const image::YuvView& frame) {
    const int width = frame.width();
    const int height = frame.height();
    if (width <= 0 || height <= 0 || width % 2 != 0 || height % 2 != 0 ||
        frame.u.width != width / 2 || frame.u.height != height / 2 || frame.v.width != width / 2 ||
        frame.v.height != height / 2) {
        return make_error(ErrorKind::kInvalidData,
                          "background picture of " + size_text(width, height) +
                              " is not a 4:2:0 picture of even size");
    }
    if (num_frames_ == 0) {
        width_ = width;
        height_ = height;
        mosaic_ = frame.mosaic;
        const auto num_pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
        sum_y_.assign(num_pixels, 0);
        sum_yy_.assign(num_pixels, 0);
        for (auto* sums : {&sum_u_, &sum_v_, &sum_uu_, &sum_uv_, &sum_vv_})
            sums->assign(num_pixels / 4, 0);
    } else if (width != width_ || height != height_) {
        return make_error(ErrorKind::kInvalidData,
                          "background pictures differ in size: first " +
                              size_text(width_, height_) + ", then " + size_text(width, height));
    } else if (frame.mosaic != mosaic_) {
        return make_error(ErrorKind::kInvalidData,
                          "background pictures differ in their colour mosaic");
    }
    if (num_frames_ == kMaxFrames) {
        return make_error(ErrorKind::kInvalidData,
                          "more than " + std::to_string(kMaxFrames) + " background pictures");
    }
    return {};
}

Expected<void> BackgroundLearner::add(const image::YuvView& frame) {
    if (auto fits = start_or_check(frame); !fits) return fits;
    ++num_frames_;
    std::size_t i = 0;
    for (int row = 0; row < height_; ++row) {
        const std::uint8_t* samples = frame.y.row(row);
        for (int x = 0; x < width_; ++x, ++i) {
            const std::uint32_t y = samples[x];
            sum_y_[i] += y;
            sum_yy_[i] += y * y;
        }
    }
    i = 0;
    for (int row = 0; row < height_ / 2; ++row) {
        const std::uint8_t* u_row = frame.u.row(row);
        const std::uint8_t* v_row = frame.v.row(row);
        for (int x = 0; x < width_ / 2; ++x, ++i) {
            const std::int32_t u = u_row[x] - 128;
            const std::int32_t v = v_row[x] - 128;
            sum_u_[i] += u;
            sum_v_[i] += v;
            sum_uu_[i] += u * u;
            sum_uv_[i] += u * v;
            sum_vv_[i] += v * v;
        }
    }
    return {};
}

Expected<BackgroundStatistics> BackgroundLearner::finish() const {
    if (num_frames_ == 0) return make_error(ErrorKind::kNotFound, "no picture of the empty room");
    BackgroundStatistics room;
    room.width = width_;
    room.height = height_;
    room.mosaic = mosaic_;
    room.num_frames = num_frames_;
    room.luma.resize(sum_y_.size());
    room.luma_sigma.resize(sum_y_.size());
    for (auto* plane : {&room.u, &room.v, &room.uu, &room.uv, &room.vv})
        plane->resize(sum_u_.size());
    const double scale = 1.0 / num_frames_;
    for (std::size_t i = 0; i < sum_y_.size(); ++i) {
        const double mean = scale * sum_y_[i];
        const double sigma = std::sqrt(std::max(scale * sum_yy_[i] - mean * mean, 0.0));
        room.luma[i] = rounded<std::uint16_t>(256.0 * mean);
        // rounding of the sums may leave a deviation just above 0
        room.luma_sigma[i] = rounded<std::uint8_t>(std::ceil(4.0 * sigma - 1e-3));
    }
    for (std::size_t i = 0; i < sum_u_.size(); ++i) {
        const double u = scale * sum_u_[i];
        const double v = scale * sum_v_[i];
        room.u[i] = rounded<std::int16_t>(128.0 * u);
        room.v[i] = rounded<std::int16_t>(128.0 * v);
        room.uu[i] = rounded<std::int16_t>(16.0 * (scale * sum_uu_[i] - u * u));
        room.uv[i] = rounded<std::int16_t>(16.0 * (scale * sum_uv_[i] - u * v));
        room.vv[i] = rounded<std::int16_t>(16.0 * (scale * sum_vv_[i] - v * v));
    }
    return room;
}

Expected<BackgroundModel> BackgroundLearner::finish(const SegmentationOptions& options) const {
    auto room = finish();
    if (!room) return tl::unexpected(room.error());
    return make_model(std::move(*room), options);
}

}  // namespace atrium::segmentation
