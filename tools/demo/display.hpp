#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

namespace atrium::demo {

/// Shows lines on standard output: refreshed in place on a terminal, elsewhere one below the other
/// and only every `period`.
class Display {
public:
    using Clock = std::chrono::steady_clock;

    explicit Display(Clock::duration period) : period_(period) {}

    /// `is_last`: shows the lines even if the period is not over.
    void show(const std::vector<std::string>& lines, bool is_last = false);
    /// Leaves what is shown and goes on below it.
    void leave();

private:
    Clock::duration period_;
    Clock::time_point next_{};
    bool in_place_ = is_terminal();
    std::size_t num_shown_ = 0;

    static bool is_terminal();
};

}  // namespace atrium::demo
