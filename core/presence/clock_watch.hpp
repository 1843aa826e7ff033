#pragma once

#include "core/base/timestamp.hpp"

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace atrium::presence {

/// Compares the clocks of other hosts with that of this one, by the times at which samples of
/// their programs were written and arrive. Uses neither network nor clock; not thread-safe.
///
/// A delay below zero proves that the other clock is ahead. The first sample of a program may have
/// waited for this one to join, thus only the shortest delay of several samples tells that the
/// other clock is behind.
class ClockWatch {
public:
    /// Differences below these are not reported: the delay of a network hides them or they are
    /// harmless.
    static constexpr std::chrono::milliseconds kAhead{100};
    static constexpr std::chrono::milliseconds kBehind{2000};

    /// Adds a sample that program `instance` of `host` wrote at `written` on its clock and that
    /// arrived at `now` on ours. Returns a line for the log, once per host.
    std::optional<std::string> see(const std::string& host,
                                   std::uint64_t instance,
                                   Timestamp written,
                                   Timestamp now);

private:
    struct Host {
        std::uint64_t instance = 0;  // the program whose samples are counted
        int num_samples = 0;
        std::chrono::nanoseconds shortest_delay{0};
        bool is_reported = false;
    };
    std::map<std::string, Host> hosts_;
};

}  // namespace atrium::presence
