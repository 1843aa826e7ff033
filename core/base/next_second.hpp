#pragma once

#include <chrono>

namespace atrium {

/// The first whole second after `begin` that is later than `now`: after a pause, a loop that waits
/// for it leaves seconds out instead of catching up.
inline std::chrono::steady_clock::time_point next_second(
    std::chrono::steady_clock::time_point begin, std::chrono::steady_clock::time_point now) {
    return begin + std::chrono::floor<std::chrono::seconds>(now - begin) + std::chrono::seconds(1);
}

}  // namespace atrium
