#pragma once

#include "core/base/timestamp.hpp"

#include <chrono>

namespace atrium::bus {

/// A sample that was written this much before or after its capture was played from a recording: a
/// site drops what is so late.
inline constexpr std::chrono::seconds kMostFromCaptureToWriting{3};

/// Returns the time from which the delays of a mesh or texture count, on the clock of its writer:
/// its capture; for a sample from a recording the time at which it was played, as its capture may
/// be years ago.
inline Timestamp delays_from(Timestamp capture_time, Timestamp written) {
    const bool is_played = std::chrono::abs(written - capture_time) > kMostFromCaptureToWriting;
    return is_played ? written : capture_time;
}

}  // namespace atrium::bus
