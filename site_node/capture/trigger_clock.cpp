#include "site_node/capture/trigger_clock.hpp"

#include <algorithm>

namespace atrium::capture {

using std::chrono::nanoseconds;

void TriggerClock::start_measuring() {
    const std::lock_guard lock(mutex_);
    state_ = State::kMeasuring;
    shot_.reset();
    num_triggers_ = 0;
    num_refused_ = 0;
}

void TriggerClock::begin_shot() {
    const std::lock_guard lock(mutex_);
    shot_.reset();
}

std::optional<Timestamp> TriggerClock::wait_for_picture(std::stop_token stop, nanoseconds timeout) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, stop, timeout, [this] { return shot_.has_value(); });
    return shot_;
}

void TriggerClock::finish_measuring(std::optional<nanoseconds> delay) {
    const std::lock_guard lock(mutex_);
    state_ = delay ? State::kKnown : State::kUnknown;
    delay_ = delay.value_or(nanoseconds(0));
}

void TriggerClock::note_trigger(Timestamp due, Timestamp sent) {
    const std::lock_guard lock(mutex_);
    triggers_[num_triggers_ % kRemembered] = {due, sent};
    ++num_triggers_;
}

std::optional<TriggerClock::Trigger> TriggerClock::nearest_trigger(Timestamp time) const {
    const std::size_t num = std::min(num_triggers_, kRemembered);
    if (num == 0) return std::nullopt;
    return *std::min_element(triggers_.begin(),
                             triggers_.begin() + static_cast<std::ptrdiff_t>(num),
                             [&](const Trigger& a, const Trigger& b) {
                                 return std::chrono::abs(time - a.sent) <
                                        std::chrono::abs(time - b.sent);
                             });
}

// A picture cannot precede its trigger: such a time is clamped to the trigger.
std::optional<Timestamp> TriggerClock::exposure_time(Timestamp time) const {
    const auto trigger = nearest_trigger(time);
    if (!trigger || trigger->sent - time > period_ / 4) return std::nullopt;
    const Timestamp taken = std::max(time, trigger->sent);
    if (taken - trigger->due >= 3 * period_ / 8) return std::nullopt;
    return taken;
}

std::optional<Timestamp> TriggerClock::on_picture(Timestamp late_time) {
    std::optional<Timestamp> taken;
    {
        const std::lock_guard lock(mutex_);
        if (state_ == State::kUnknown) return late_time;
        if (state_ == State::kKnown) {
            taken = exposure_time(late_time + -delay_);
            num_refused_ = taken ? 0 : num_refused_ + 1;
            // a delay measured on a busy machine is too long; corrected here
            if (taken) delay_ = std::min(delay_, late_time - *taken);
            return taken;
        }
        if (!shot_) shot_ = late_time;
    }
    changed_.notify_all();
    return std::nullopt;
}

std::optional<Timestamp> TriggerClock::on_lost_picture(Timestamp late_time) const {
    const std::lock_guard lock(mutex_);
    if (state_ == State::kUnknown) return late_time;
    if (state_ == State::kMeasuring) return std::nullopt;
    return exposure_time(late_time + -delay_);
}

bool TriggerClock::needs_measuring() const {
    const std::lock_guard lock(mutex_);
    return state_ == State::kKnown && num_refused_ >= kMaxRefused;
}

std::optional<nanoseconds> TriggerClock::delay() const {
    const std::lock_guard lock(mutex_);
    if (state_ != State::kKnown) return std::nullopt;
    return delay_;
}

}  // namespace atrium::capture
