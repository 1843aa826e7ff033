#include "core/presence/kernel_clock.hpp"

#include <sys/timex.h>

namespace atrium::presence {

KernelClock kernel_clock() {
    timex clock{};
    const int state = ::adjtimex(&clock);
    return {state >= 0 && state != TIME_ERROR && (clock.status & STA_UNSYNC) == 0,
            std::chrono::microseconds(clock.maxerror)};
}

}  // namespace atrium::presence
