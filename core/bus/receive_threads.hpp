#pragma once

#include "core/base/descriptor.hpp"

#include <chrono>
#include <cstddef>
#include <list>

namespace atrium::bus {

/// The threads of this process in which Cyclone DDS takes datagrams from its sockets and puts
/// samples into readers.
///
/// Whoever knows that they all sleep knows that nothing waits in a socket: a thread that has
/// something to do does not sleep, whether it runs or waits for a processor.
class ReceiveThreads {
public:
    ReceiveThreads();

    /// What had come to this host before the call is in the readers, or was taken from them. Looks
    /// once a second which threads there are. Never true before it has looked twice: a thread has
    /// its name only once it has run. Where the system does not tell (there is no /proc) true is
    /// assumed.
    bool are_asleep();
    std::size_t size() const { return states_.size(); }

private:
    using Clock = std::chrono::steady_clock;
    void find();

    std::list<Descriptor> states_;  // /proc/self/task/*/stat
    bool is_told_ = true;           // there is such a folder
    bool is_settled_ = false;
    Clock::time_point found_;
};

}  // namespace atrium::bus
