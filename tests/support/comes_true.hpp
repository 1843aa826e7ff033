#pragma once

#include <chrono>
#include <functional>
#include <thread>

namespace atrium::test_support {

/// Checks repeatedly until it is true. Returns false after a minute.
inline bool comes_true(const std::function<bool()>& condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (!condition()) {
        if (std::chrono::steady_clock::now() > end) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
}

}  // namespace atrium::test_support
