#pragma once

#include "core/base/timestamp.hpp"

#include <array>
#include <ctime>
#include <string>

namespace atrium::viewer {

/// "2026-11-28 14:05" in the time zone of this host; empty for times that it cannot show.
inline std::string local_time_text(Timestamp time) {
    const std::time_t seconds = time.ns / 1'000'000'000;
    std::tm parts{};
    if (localtime_r(&seconds, &parts) == nullptr) return {};
    std::array<char, 32> text{};
    std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M", &parts);
    return text.data();
}

}  // namespace atrium::viewer
