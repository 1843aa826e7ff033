#pragma once

#include "core/base/timestamp.hpp"

#include <array>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>

namespace atrium::capture {

/// Tells by which trigger of the site a camera took a picture, where the site triggers.
///
/// CameraClock puts times of a camera on the site's clock by the least delay between picture and
/// arrival: they stay late by that delay, and a delay of more than half a period could not be told
/// from a trigger later. Here it is measured, with single triggers that no other can be mistaken
/// for, and taken off. From then on a picture that was not taken soon after a trigger is refused:
/// those of one trigger lie less than 3/8 of a period apart, those of two triggers more than 5/8.
///
/// Thread-safe: one thread triggers and measures, another receives.
class TriggerClock {
public:
    explicit TriggerClock(std::chrono::nanoseconds period) : period_(period) {}

    /// A trigger that is later than so much has to be left out: it is a quarter of the period.
    std::chrono::nanoseconds longest_late() const { return period_ / 4; }

    /// From now on pictures are measured and no longer accepted; what was known is forgotten.
    void start_measuring();
    /// Forgets the picture that `wait_for_picture` waits for.
    void begin_shot();
    /// The time of the first picture since `begin_shot`, before any delay is taken off. Nothing
    /// once a stop is requested or `timeout` has passed.
    std::optional<Timestamp> wait_for_picture(std::stop_token stop,
                                              std::chrono::nanoseconds timeout);
    /// Ends the measuring. None: it could not be measured, and all pictures are accepted as they
    /// are.
    void finish_measuring(std::optional<std::chrono::nanoseconds> delay);

    /// The camera is asked for a picture at `sent`, by a beat that was due at `due`.
    void note_trigger(Timestamp due, Timestamp sent);

    /// When a picture was taken, whose time is `late_time` by CameraClock; nothing where it is not
    /// to be used.
    std::optional<Timestamp> on_picture(Timestamp late_time);
    /// The same for a picture that is lost: nothing is learned from it.
    std::optional<Timestamp> on_lost_picture(Timestamp late_time) const;

    /// True where so many pictures in a row were refused that the delay has to be measured anew.
    bool is_astray() const;

    /// Between picture and arrival; none where it is not known.
    std::optional<std::chrono::nanoseconds> delay() const;

private:
    enum class State { kMeasuring, kKnown, kUnknown };
    struct Trigger {
        Timestamp due;
        Timestamp sent;
    };
    static constexpr std::size_t kRemembered = 64;
    static constexpr int kMaxRefused = 40;

    std::optional<Trigger> nearest(Timestamp time) const;
    std::optional<Timestamp> placed(Timestamp time) const;

    std::chrono::nanoseconds period_;
    mutable std::mutex mutex_;
    std::condition_variable_any changed_;
    State state_ = State::kUnknown;
    std::optional<Timestamp> shot_;  // of the present shot
    std::chrono::nanoseconds delay_{};
    std::array<Trigger, kRemembered> triggers_;  // a ring
    std::size_t num_triggers_ = 0;
    int num_refused_ = 0;  // in a row
};

}  // namespace atrium::capture
