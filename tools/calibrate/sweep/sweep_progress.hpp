#pragma once

#include "tools/calibrate/sweep/sweep_tally.hpp"

#include <chrono>
#include <string>

namespace atrium::calibrate {

/// Shows how far a sweep is, on standard error: on a terminal one line that is written over, else a
/// line every five seconds. Clears its line when it ends.
class SweepProgress {
public:
    using Clock = std::chrono::steady_clock;

    SweepProgress();
    ~SweepProgress();
    SweepProgress(const SweepProgress&) = delete;
    SweepProgress& operator=(const SweepProgress&) = delete;

    /// Shows the tally, if it is time, and new warnings at once.
    void update(SweepTally& tally);

    /// Shows a line that stays.
    void say(const std::string& line);

    /// When `update` shows something next.
    Clock::time_point due() const { return due_; }

private:
    bool is_terminal_;
    Clock::time_point due_;
};

}  // namespace atrium::calibrate
