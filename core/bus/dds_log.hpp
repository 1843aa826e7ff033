#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace atrium::bus {

/// Reduces Cyclone's log, which repeats a failure for every datagram, to one line per kind of
/// message at once and then one per minute with the number of repetitions. Thread-safe.
class DdsLog {
public:
    using Clock = std::chrono::steady_clock;

    /// Adds a line that Cyclone logs.
    void add(std::string_view line, Clock::time_point now = Clock::now());
    /// Adds a line of ours. Lines of the same `kind` count as repetitions.
    void add(const std::string& kind,
             const std::string& line,
             Clock::time_point now = Clock::now());
    /// Returns the lines to log since the last call: with their number, if there are several, and
    /// the seconds since the last one, if it was held back.
    std::vector<std::string> take(Clock::time_point now);

    /// The log of this process. The first call directs Cyclone's messages to it.
    static DdsLog& of_process();

    /// Collects the unchanged text of all messages from here to `end_capture`, while a domain is
    /// opened: only they have the reason of a failure. They are not returned by `take`.
    void begin_capture();
    std::string end_capture();

private:
    struct Kind {
        std::string line;            // what to log
        std::size_t num_new = 0;     // since it was last logged
        Clock::time_point added{};   // the last time
        Clock::time_point logged{};  // zero: never
    };
    void count(const std::string& kind,
               const std::string& line,
               Clock::time_point now);  // `mutex_` is held
    std::mutex mutex_;
    std::map<std::string, Kind> kinds_;
    Clock::time_point taken_{};           // the last time
    std::size_t num_of_other_kinds_ = 0;  // beyond the limit
    bool is_captured_ = false;
    std::string captured_;
};

}  // namespace atrium::bus
