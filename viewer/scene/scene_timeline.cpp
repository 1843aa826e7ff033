#include "viewer/scene/scene_timeline.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <utility>

namespace atrium::viewer {
namespace {

constexpr double kPeriodSmoothing = 0.1;
// growth of the offset, which follows a drifting clock: 1 ms in 100 states
constexpr double kOffsetCreepNs = 1e4;
constexpr double kClockStepNs = 1e9;  // a larger difference means that a clock was set

double ns_since_start(SceneTimeline::Clock::time_point t) {
    return static_cast<double>(
        std::chrono::duration_cast<std::chrono::nanoseconds>(t.time_since_epoch()).count());
}

bus::ObjectState extrapolate(const bus::ObjectState& from, double seconds) {
    bus::ObjectState state = from;
    state.world_from_object.translation += from.linear_velocity * seconds;
    const Eigen::Vector3d turn = from.angular_velocity * seconds;
    const double angle = turn.norm();
    if (angle > 1e-9) {
        const Eigen::Quaterniond world_turn(Eigen::AngleAxisd(angle, turn / angle));
        state.world_from_object.rotation =
            (world_turn * from.world_from_object.rotation).normalized();
    }
    return state;
}

const bus::ObjectState* find(const bus::SceneState& state, std::uint32_t object) {
    for (const bus::ObjectState& candidate : state.objects)
        if (candidate.object == object) return &candidate;
    return nullptr;
}

bus::ObjectState between(const bus::ObjectState& a, const bus::ObjectState& b, double t) {
    // a longer way in one step is a reset, not a motion
    constexpr double kJumpM = 1.0;
    const Eigen::Vector3d way = b.world_from_object.translation - a.world_from_object.translation;
    if (way.squaredNorm() > kJumpM * kJumpM) return b;
    bus::ObjectState state = b;
    state.world_from_object.translation = a.world_from_object.translation + t * way;
    state.world_from_object.rotation =
        a.world_from_object.rotation.slerp(t, b.world_from_object.rotation);
    return state;
}

}  // namespace

void SceneTimeline::add(bus::SceneState state, Clock::time_point arrival) {
    const double offset = ns_since_start(arrival) - static_cast<double>(state.time.ns);
    if (!states_.empty()) {
        const auto step = static_cast<double>((state.time - states_.back().time).count());
        // the world restarted, or a clock was set
        if (std::abs(offset - offset_ns_) > kClockStepNs || step < -kClockStepNs)
            clear();
        else if (step <= 0.0)
            return;
        else {
            const double limit = static_cast<double>(options_.max_delay.count());
            const double clamped = std::min(step, limit);
            period_ns_ = period_ns_ == 0.0 ? clamped
                                           : period_ns_ + kPeriodSmoothing * (clamped - period_ns_);
        }
    }
    offset_ns_ = states_.empty() ? offset : std::min(offset, offset_ns_ + kOffsetCreepNs);
    states_.push_back(std::move(state));
    if (states_.size() > options_.max_states) states_.pop_front();
}

void SceneTimeline::clear() {
    states_.clear();
    period_ns_ = 0.0;
}

void SceneTimeline::sample(Clock::time_point now, std::vector<bus::ObjectState>& out) const {
    out.clear();
    if (const auto time = shown_time(now)) sample_at(*time, out);
}

std::optional<Timestamp> SceneTimeline::shown_time(Clock::time_point now) const {
    if (states_.empty()) return std::nullopt;
    return Timestamp{std::llround(ns_since_start(now) - offset_ns_ - period_ns_)};
}

void SceneTimeline::sample_at(Timestamp time, std::vector<bus::ObjectState>& out) const {
    out.clear();
    if (states_.empty()) return;
    const auto wanted = static_cast<double>(time.ns);
    const auto after =
        std::find_if(states_.begin(), states_.end(), [&](const bus::SceneState& state) {
            return static_cast<double>(state.time.ns) >= wanted;
        });
    if (after == states_.end()) {
        const double ahead = std::min(wanted - static_cast<double>(states_.back().time.ns),
                                      static_cast<double>(options_.max_extrapolation.count()));
        for (const bus::ObjectState& object : states_.back().objects)
            out.push_back(extrapolate(object, ahead * 1e-9));
        return;
    }
    if (after == states_.begin()) {
        out = after->objects;
        return;
    }
    const bus::SceneState& before = *std::prev(after);
    const double t = (wanted - static_cast<double>(before.time.ns)) /
                     static_cast<double>((after->time - before.time).count());
    for (const bus::ObjectState& object : after->objects) {
        const bus::ObjectState* former = find(before, object.object);
        out.push_back(former != nullptr ? between(*former, object, t) : object);
    }
}

}  // namespace atrium::viewer
