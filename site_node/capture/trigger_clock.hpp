#pragma once

#include "core/base/timestamp.hpp"

#include <array>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>

namespace atrium::capture {

/// Assigns each picture of a software-triggered camera to its trigger.
///
/// CameraClock converts camera times by the smallest delay between picture and arrival. Its times
/// stay late by that delay, and a delay above half a period is ambiguous with the next trigger.
/// This class measures the delay with isolated triggers and subtracts it. Afterwards it rejects
/// each picture that was not taken soon after a trigger: pictures of one trigger are less than 3/8
/// of a period apart, those of two triggers more than 5/8.
///
/// Thread-safe: one thread triggers and measures, another receives.
class TriggerClock {
public:
    explicit TriggerClock(std::chrono::nanoseconds period) : period_(period) {}

    /// A trigger later than this, a quarter of the period, must be skipped.
    std::chrono::nanoseconds longest_late() const { return period_ / 4; }

    /// Starts to measure and rejects pictures until `finish_measuring`. Discards all earlier state.
    void start_measuring();
    /// Discards the picture for which `wait_for_picture` waits.
    void begin_shot();
    /// Waits for the first picture since `begin_shot` and returns its time, with the delay. Empty
    /// once a stop is requested or `timeout` passes.
    std::optional<Timestamp> wait_for_picture(std::stop_token stop,
                                              std::chrono::nanoseconds timeout);
    /// Ends the measurement. An empty `delay` means that it failed; all pictures are then accepted
    /// unchanged.
    void finish_measuring(std::optional<std::chrono::nanoseconds> delay);

    /// Records a trigger sent at `sent` for the beat due at `due`.
    void note_trigger(Timestamp due, Timestamp sent);

    /// Returns the exposure time of a picture that CameraClock puts at `late_time`; empty if it
    /// must be discarded.
    std::optional<Timestamp> on_picture(Timestamp late_time);
    /// Like `on_picture` for a lost picture, but learns nothing from it.
    std::optional<Timestamp> on_lost_picture(Timestamp late_time) const;

    /// True if so many pictures in a row were rejected that the delay must be measured again.
    bool needs_measuring() const;

    /// Delay between exposure and arrival; empty if unknown.
    std::optional<std::chrono::nanoseconds> delay() const;

private:
    enum class State { kMeasuring, kKnown, kUnknown };
    struct Trigger {
        Timestamp due;
        Timestamp sent;
    };
    static constexpr std::size_t kRemembered = 64;
    static constexpr int kMaxRefused = 40;

    std::optional<Trigger> nearest_trigger(Timestamp time) const;
    std::optional<Timestamp> exposure_time(Timestamp time) const;

    std::chrono::nanoseconds period_;
    mutable std::mutex mutex_;
    std::condition_variable_any changed_;
    State state_ = State::kUnknown;
    std::optional<Timestamp> shot_;  // of the current shot
    std::chrono::nanoseconds delay_{};
    std::array<Trigger, kRemembered> triggers_;  // a ring
    std::size_t num_triggers_ = 0;
    int num_refused_ = 0;  // in a row
};

}  // namespace atrium::capture
