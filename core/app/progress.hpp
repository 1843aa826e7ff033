#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>

namespace atrium::app {

/// Progress of long work, for the log: "frame 1200 of 54000, 11/s, 1 h 20 min left".
class Progress {
public:
    using Clock = std::chrono::steady_clock;

    /// `thing` is the word for one piece of work.
    Progress(std::string thing,
             std::size_t total,
             Clock::duration interval = std::chrono::seconds(1),
             Clock::time_point begin = Clock::now())
        : thing_(std::move(thing)),
          total_(total),
          interval_(interval),
          begin_(begin),
          last_(begin) {}

    /// Returns a line if `interval` has passed since the last one.
    std::optional<std::string> update(std::size_t done, Clock::time_point now = Clock::now());

private:
    std::string thing_;
    std::size_t total_;
    Clock::duration interval_;
    Clock::time_point begin_;
    Clock::time_point last_;
};

/// "40 s", "12 min", "1 h 20 min".
std::string duration_text(std::chrono::duration<double> duration);

}  // namespace atrium::app
