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

/// Interpolates the poses of rigid objects between two SceneStates.
///
/// The shown time lies one send period in the past, so a state exists on either side. If the next
/// state is late, objects continue with their last velocity for at most `max_extrapolation`. The
/// clocks of world server and viewer need not agree: the shortest difference between arrival and
/// state time estimates the offset, as the transit without a queue. Not thread-safe.
class SceneTimeline {
public:
    using Clock = std::chrono::steady_clock;

    explicit SceneTimeline(const SceneTimelineOptions& options = {}) : options_(options) {}

    void add(bus::SceneState state, Clock::time_point arrival);
    /// Time on the world's clock to show at `now`. Empty before the first state.
    std::optional<Timestamp> shown_time(Clock::time_point now) const;
    /// Poses at `time` on the world's clock. All viewers with the states around it compute the
    /// same.
    void sample_at(Timestamp time, std::vector<bus::ObjectState>& out) const;
    /// Poses at `now`, for the objects of the newest state that is not ahead of it.
    void sample(Clock::time_point now, std::vector<bus::ObjectState>& out) const;
    void clear();

private:
    SceneTimelineOptions options_;
    std::deque<bus::SceneState> states_;  // rising times, at most max_states
    double offset_ns_ = 0.0;  // arrival on the local clock minus time on the world's clock
    double period_ns_ = 0.0;
};

}  // namespace atrium::viewer
