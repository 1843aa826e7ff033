#pragma once

#include "core/base/statistics.hpp"
#include "core/base/timestamp.hpp"

#include <chrono>
#include <string>

namespace atrium::viewer {

/// How long the drawing thread is busy. Not thread-safe.
class DrawingTimes {
public:
    using Duration = std::chrono::steady_clock::duration;

    /// With what each of the people who are new in a picture cost it, before it was drawn.
    void add_people(Duration duration) { people_.add(duration); }
    /// With what is done for a picture before it is drawn.
    void add_preparation(Duration duration);
    /// With a whole picture, but for waiting until it is due.
    void add_picture(Duration duration);
    /// With the way of somebody who is new in a picture: from the complete pair to the decoded
    /// person, from there to the begin of the picture, and from the complete pair to its display.
    void add_way(Duration decoding, Duration waiting, Duration to_display);
    /// Forgets the pictures that were before, which did not count.
    void begin_pictures() { longest_ = longest_preparation_ = {}; }
    /// "taking_in_ms=..." and more of the kind, for the log.
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
