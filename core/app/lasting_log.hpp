#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

namespace atrium::app::log {

/// Logs a state that may last for days: at once, after a second, then each time after twice as
/// long, up to about two minutes. Another state is logged at once, but never more than one line per
/// second. Adds the number of suppressed lines (`held_back=`). Thread-safe.
class LastingLog {
public:
    using Time = std::chrono::steady_clock::time_point;

    /// `state` says what is the same as before; `line` may differ each time.
    void warn(std::string_view state, std::string_view line);

    /// The line to log; nullopt if it is suppressed.
    std::optional<std::string> next(std::string_view state, std::string_view line, Time now);

private:
    std::mutex mutex_;
    std::string state_;
    std::optional<Time> last_seen_;
    std::optional<Time> last_logged_;
    std::chrono::seconds period_{1};
    std::size_t num_held_back_ = 0;
};

}  // namespace atrium::app::log
