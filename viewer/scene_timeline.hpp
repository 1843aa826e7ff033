#pragma once

#include "core/bus/messages.hpp"

#include <chrono>
#include <deque>
#include <optional>
#include <vector>

namespace atrium::viewer {

struct SceneTimelineOptions {
    std::chrono::nanoseconds max_extrapolation = std::chrono::milliseconds(50);
    std::chrono::nanoseconds max_delay = std::chrono::milliseconds(100);
    std::size_t max_states = 8;
};

/// Where the objects are at any moment between two SceneStates.
///
/// What is shown lies one send period in the past, so that there is a state on either side to
/// interpolate between; where the next one is late, objects move on with their last velocity for
/// `max_extrapolation` at most. The world server's clock need not agree with ours: what counts is
/// its distance to the arrivals, of which the shortest is taken for the way without a queue.
/// Not thread-safe.
class SceneTimeline {
public:
    using Clock = std::chrono::steady_clock;

    explicit SceneTimeline(const SceneTimelineOptions& options = {}) : options_(options) {}

    void add(bus::SceneState state, Clock::time_point arrival);
    /// The moment of the world's clock that is shown at `now`; nothing before the first state.
    std::optional<Timestamp> shown_time(Clock::time_point now) const;
    /// Poses at that moment of the world's clock: the same in all viewers that have the states
    /// around it.
    void sample_at(Timestamp time, std::vector<bus::ObjectState>& out) const;
    /// Poses at `now`, of the objects in the newest state that is not ahead of them.
    void sample(Clock::time_point now, std::vector<bus::ObjectState>& out) const;
    void clear();

private:
    SceneTimelineOptions options_;
    std::deque<bus::SceneState> states_;  // rising times, a few
    double offset_ns_ = 0.0;              // our clock minus the world's, as it arrives here
    double period_ns_ = 0.0;
};

}  // namespace atrium::viewer
