#pragma once

#include "tools/calibrate/sweep/observer.hpp"

#include <chrono>
#include <string>
#include <vector>

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

    /// Shows the progress, if it is time, and new warnings at once.
    void update(Observer& observer);

    /// Shows a line that stays.
    void say(const std::string& line);

    /// When `update` shows something next.
    Clock::time_point due() const { return due_; }

private:
    bool is_terminal_;
    Clock::time_point due_;
};

/// "head; part; part". At most `most_characters` long, and then without the last parts; 0: all.
std::string progress_line(std::string head,
                          const std::vector<std::string>& parts,
                          std::size_t most_characters);

}  // namespace atrium::calibrate
