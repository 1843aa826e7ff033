#pragma once

#include "core/base/statistics.hpp"
#include "core/base/timestamp.hpp"

#include <chrono>
#include <string>

namespace atrium::viewer {

/// Measures the time of the drawing thread per picture. Not thread-safe.
class DrawingTimes {
public:
    using Duration = std::chrono::steady_clock::duration;

    /// Adds the time to upload one new person.
    void add_people(Duration duration) { people_.add(duration); }
    /// Adds the time to prepare a picture before it is drawn.
    void add_preparation(Duration duration);
    /// Adds the time of a whole picture without the wait for its due time.
    void add_picture(Duration duration);
    /// Adds the latencies of a person who is new in a picture: complete pair to decoded person,
    /// decoded person to start of the picture, complete pair to display.
    void add_way(Duration decoding, Duration waiting, Duration to_display);
    /// Forgets the maxima of the pictures before the counted run.
    void begin_pictures() { longest_ = longest_preparation_ = {}; }
    /// Returns the fields "taking_in_ms=..." and so on for the log.
    std::string text() const;

private:
    LatencyWindow people_;
    LatencyWindow pictures_;
    LatencyWindow decoding_;
    LatencyWindow waiting_;
    LatencyWindow to_display_;
    Duration longest_{};
    Duration longest_preparation_{};
};

}  // namespace atrium::viewer
