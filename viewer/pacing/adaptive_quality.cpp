#include "viewer/pacing/adaptive_quality.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

namespace atrium::viewer {
namespace {

using Clock = AdaptiveQuality::Clock;

constexpr double kTooBusy = 0.9;   // share of the period that drawing may take
constexpr double kHasRoom = 0.7;   // expected share that allows a better level
constexpr double kTooLateS = 0.1;  // limit for decoding a person
constexpr double kSoonS = 0.06;    // decoding time that allows a better level
// A decision takes this many pictures and this long, whichever is more.
constexpr std::size_t kPictures = 6;
constexpr std::chrono::milliseconds kWindow{400};
constexpr std::chrono::seconds kLeastPatience{2};
constexpr std::chrono::seconds kMostPatience{64};
constexpr std::chrono::seconds kTrial{10};

constexpr std::array kRates{60.0, 30.0, 20.0, 15.0};
constexpr std::array kScales{0.75, 0.5};
constexpr double kShadowCost = 1.3;  // cost of a picture with shadows over one without

double median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// Upper bound of the ratio of drawing times.
double cost_ratio(const PictureQuality& more, const PictureQuality& less) {
    const double side = more.scale / less.scale;
    return side * side * (more.has_shadows && !less.has_shadows ? kShadowCost : 1.0);
}

}  // namespace

AdaptiveQuality::AdaptiveQuality(const PictureQuality& best)
    : levels_{best}, patience_(kLeastPatience) {
    assert(best.max_fps > 0.0 && best.scale > 0.0 && best.scale <= 1.0);
    PictureQuality level = best;
    for (const double rate : kRates) {
        if (rate >= 0.9 * level.max_fps) continue;
        level.max_fps = rate;
        levels_.push_back(level);
    }
    for (const double scale : kScales) {
        if (scale >= level.scale) continue;
        level.scale = scale;
        levels_.push_back(level);
    }
    if (std::exchange(level.has_shadows, false)) levels_.push_back(level);
}

void AdaptiveQuality::begin_window(Clock::time_point now) {
    busy_s_.clear();
    late_s_.clear();
    window_begin_ = now;
    has_window_ = true;
}

void AdaptiveQuality::change_to(std::size_t level, const char* reason, Clock::time_point now) {
    const bool is_better = level < level_;
    if (is_better) {
        raised_at_ = now;
        is_trial_ = true;
    } else {
        if (is_trial_) patience_ = std::min<Clock::duration>(2 * patience_, kMostPatience);
        is_trial_ = false;
    }
    level_ = level;
    reason_ = reason;
    room_for_ = Clock::duration(0);
}

bool AdaptiveQuality::has_room_above(double busy_s, double late_s) const {
    if (level_ == 0 || late_s > kSoonS) return false;
    const PictureQuality& better = levels_[level_ - 1];
    return busy_s * cost_ratio(better, quality()) * better.max_fps < kHasRoom;
}

bool AdaptiveQuality::add(const Picture& picture) {
    const auto seconds = [](Clock::duration d) { return std::chrono::duration<double>(d).count(); };
    if (!has_window_) begin_window(picture.ended - picture.busy);
    busy_s_.push_back(seconds(picture.busy));
    late_s_.push_back(seconds(picture.late_people));
    const Clock::duration window = picture.ended - window_begin_;
    if (busy_s_.size() < kPictures || window < kWindow) return false;
    const double busy_s = median(busy_s_);
    const double late_s = median(late_s_);
    begin_window(picture.ended);
    if (is_trial_ && picture.ended - raised_at_ > kTrial) {
        is_trial_ = false;
        patience_ = std::max<Clock::duration>(patience_ / 2, kLeastPatience);
    }

    const bool is_drawing_slow = busy_s * quality().max_fps > kTooBusy;
    if (is_drawing_slow || late_s > kTooLateS) {
        room_for_ = Clock::duration(0);
        std::size_t next = level_ + 1;
        if (next >= levels_.size()) return false;
        // a lower rate does not change the cost per picture, so skip rates that are still too high
        while (is_drawing_slow && next + 1 < levels_.size() &&
               levels_[next].scale == quality().scale &&
               busy_s * levels_[next].max_fps > kTooBusy &&
               levels_[next + 1].max_fps < levels_[next].max_fps)
            ++next;
        change_to(next, is_drawing_slow ? "drawing" : "decoding", picture.ended);
        return true;
    }
    if (!has_room_above(busy_s, late_s)) {
        room_for_ = Clock::duration(0);
        return false;
    }
    room_for_ += window;
    if (room_for_ < patience_) return false;
    change_to(level_ - 1, "time_to_spare", picture.ended);
    return true;
}

std::string to_string(const PictureQuality& quality) {
    return fmt::format("fps={:.3g} scale={:.3g} shadows={}",
                       quality.max_fps,
                       quality.scale,
                       quality.has_shadows ? "on" : "off");
}

std::string describe(const PictureQuality& quality) {
    std::string text = fmt::format("{:.0f} pictures/s", quality.max_fps);
    if (quality.scale < 1.0)
        text += fmt::format(", {:.0f} % of the resolution", 100.0 * quality.scale);
    return quality.has_shadows ? text : text + ", no shadows";
}

}  // namespace atrium::viewer
