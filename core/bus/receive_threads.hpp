#pragma once

#include "core/base/descriptor.hpp"

#include <chrono>
#include <cstddef>
#include <list>

namespace atrium::bus {

/// Observes the threads of this process in which Cyclone DDS receives datagrams and delivers
/// samples to readers.
///
/// If all of them sleep, no datagram waits in a socket: a thread with work to do does not sleep, it
/// runs or waits for a core.
class ReceiveThreads {
public:
    ReceiveThreads();

    /// True if all data that reached this host before the call is in the readers or was taken from
    /// them. Lists the threads once a second. False until it has listed them twice, because a
    /// thread gets its name only when it runs. Always true without /proc.
    bool are_asleep();
    std::size_t size() const { return states_.size(); }

private:
    using Clock = std::chrono::steady_clock;
    void find();

    std::list<Descriptor> states_;   // /proc/self/task/*/stat
    bool can_list_ = true;           // /proc/self/task can be read
    bool was_listed_twice_ = false;  // the threads were listed twice
    Clock::time_point found_;
};

}  // namespace atrium::bus
