#pragma once

#include <sys/resource.h>
#include <unistd.h>

namespace atrium {

/// Steps of nice(1) from the highest priority to the lowest.
inline constexpr int kAllPrioritySteps = 39;

/// Makes the calling thread `steps` nicer than it is, at most until the lowest priority: on Linux
/// each thread has its own.
inline void lower_thread_priority(int steps = kAllPrioritySteps) {
    const auto self = static_cast<id_t>(gettid());
    setpriority(PRIO_PROCESS, self, getpriority(PRIO_PROCESS, self) + steps);
}

}  // namespace atrium
