#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

namespace atrium::viewer {

/// What a picture may cost.
struct PictureQuality {
    double max_fps = 30.0;  // [Hz]
    double scale = 1.0;     // of the picture's width and height, in (0, 1]
    bool has_shadows = true;

    bool operator==(const PictureQuality&) const = default;
};

/// Finds the picture quality that the machine can keep up with.
///
/// It is given what each picture took, and gives way in this order: drawing rate, resolution,
/// shadows. A level is too much if the drawing thread is busy for most of the time between two
/// pictures, or if people wait long to be decoded; then the pictures get cheaper within half a
/// second. They get better again, one level at a time, once the next better level would leave room
/// for some seconds. A better level that proves too much is tried again after twice as long, so
/// that it does not oscillate. Has no clock: all times are given. Not thread-safe.
class GivingWay {
public:
    using Clock = std::chrono::steady_clock;

    /// `best` is level 0; rates below 15 Hz, scales below 0.5 are not proposed.
    explicit GivingWay(const PictureQuality& best);

    struct Picture {
        Clock::time_point ended;
        Clock::duration busy{0};         // of the drawing thread
        Clock::duration late_people{0};  // from complete to decoded, of the latest in the picture
    };
    /// After each picture. Returns whether `quality` changed.
    bool add(const Picture& picture);

    const PictureQuality& quality() const { return levels_[level_]; }
    /// 0: the best; more: cheaper.
    std::size_t level() const { return level_; }
    std::size_t num_levels() const { return levels_.size(); }
    /// Why it changed last, for the log: "drawing" or "decoding" took too long, or there is "room".
    const std::string& reason() const { return reason_; }

private:
    void begin_window(Clock::time_point now);
    bool has_room_above(double busy_s, double late_s) const;
    void change_to(std::size_t level, const char* reason, Clock::time_point now);

    std::vector<PictureQuality> levels_;
    std::size_t level_ = 0;
    std::string reason_;

    // pictures since the level changed or the last decision
    std::vector<double> busy_s_;
    std::vector<double> late_s_;
    Clock::time_point window_begin_{};
    bool has_window_ = false;

    Clock::duration room_for_{0};    // how long the next better level would have had room
    Clock::duration patience_;       // how long it has to
    Clock::time_point raised_at_{};  // when the quality got better last
    bool is_trial_ = false;          // it may prove too much
};

/// "fps=15 scale=0.75 shadows=on"
std::string to_string(const PictureQuality& quality);

}  // namespace atrium::viewer
