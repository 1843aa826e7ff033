#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

namespace atrium::viewer {

/// Limits on the cost of a picture.
struct PictureQuality {
    double max_fps = 30.0;  // [Hz]
    double scale = 1.0;     // share of the picture's width and height, in (0, 1]
    bool has_shadows = true;

    bool operator==(const PictureQuality&) const = default;
};

/// Finds the best picture quality that the machine can sustain.
///
/// Takes the cost of each picture and reduces, in this order: drawing rate, resolution, shadows. A
/// level is too expensive if the drawing thread is busy for most of the period, or if people wait
/// long to be decoded; the quality then drops within half a second. The quality rises by one level
/// once the better level would have had room for some seconds. If the better level turns out too
/// expensive, the wait before the next attempt doubles, which prevents oscillation. Has no clock:
/// the caller passes all times. Not thread-safe.
class AdaptiveQuality {
public:
    using Clock = std::chrono::steady_clock;

    /// `best` is level 0. Levels below 15 Hz or half the size are not used.
    explicit AdaptiveQuality(const PictureQuality& best);

    struct Picture {
        Clock::time_point ended;
        Clock::duration busy{0};  // busy time of the drawing thread
        /// Complete to decoded, maximum over the people new in the picture.
        Clock::duration late_people{0};
    };
    /// Call after each picture. Returns whether `quality` changed.
    bool add(const Picture& picture);

    const PictureQuality& quality() const { return levels_[level_]; }
    /// 0 is the best; higher levels are cheaper.
    std::size_t level() const { return level_; }
    std::size_t num_levels() const { return levels_.size(); }
    /// Reason of the last change, for the log: "drawing" or "decoding" took too long, or there was
    /// "time_to_spare".
    const std::string& reason() const { return reason_; }

private:
    void begin_window(Clock::time_point now);
    bool has_room_above(double busy_s, double late_s) const;
    void change_to(std::size_t level, const char* reason, Clock::time_point now);

    std::vector<PictureQuality> levels_;
    std::size_t level_ = 0;
    std::string reason_;

    // pictures since the last decision
    std::vector<double> busy_s_;
    std::vector<double> late_s_;
    Clock::time_point window_begin_{};
    bool has_window_ = false;

    Clock::duration room_for_{0};    // time for which the next better level would have had room
    Clock::duration patience_;       // time that it needs to have room
    Clock::time_point raised_at_{};  // last increase
    bool is_trial_ = false;          // the last increase may turn out too expensive
};

/// For the log: "fps=15 scale=0.75 shadows=on"
std::string to_string(const PictureQuality& quality);
/// For the user: "15 pictures/s, 75 % of the resolution, no shadows"
std::string describe(const PictureQuality& quality);

}  // namespace atrium::viewer
