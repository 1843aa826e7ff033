#pragma once

#include <chrono>
#include <cstdint>

namespace atrium::viewer {

/// What the user wants of the recording that is shown.
struct PlaybackEvent {
    enum class Kind : std::uint8_t {
        kToggle,   // play or pause
        kStep,     // `number` frames, negative: backwards
        kSeek,     // to `time` since the beginning
        kSeekBy,   // by `time`
        kSpeed,    // to `factor`
        kSpeedBy,  // times `factor`
        kToggleLoop,
        kMarkIn,   // here
        kMarkOut,  // here
        kClearMarks,
        kKeepView,  // the viewpoint as a key of the camera path
    };
    Kind kind = Kind::kToggle;
    int number = 0;
    std::chrono::nanoseconds time{0};
    double factor = 1.0;
};

}  // namespace atrium::viewer
