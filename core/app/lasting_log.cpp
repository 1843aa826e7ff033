#include "core/app/lasting_log.hpp"

#include "core/app/log.hpp"

#include <algorithm>
#include <utility>

namespace atrium::app::log {
namespace {

constexpr std::chrono::seconds kShortest{1};
constexpr std::chrono::seconds kLongest{128};
constexpr std::chrono::seconds kCalm{5};  // a state that was not seen for so long has ended

}  // namespace

std::optional<std::string> LastingLog::next(std::string_view state,
                                            std::string_view line,
                                            Time now) {
    const std::lock_guard lock(mutex_);
    const bool lasts = last_seen_ && state == state_ && now - *last_seen_ < kCalm;
    last_seen_ = now;
    if (!lasts) {
        state_ = state;
        period_ = kShortest;
    }
    if (last_logged_ && now - *last_logged_ < period_) {
        ++num_held_back_;
        return std::nullopt;
    }
    if (lasts) period_ = std::min(2 * period_, kLongest);
    last_logged_ = now;
    const std::size_t held_back = std::exchange(num_held_back_, 0);
    return held_back > 0 ? fmt::format("{} held_back={}", line, held_back) : std::string(line);
}

void LastingLog::warn(std::string_view state, std::string_view line) {
    if (const auto text = next(state, line, std::chrono::steady_clock::now()))
        log::warn("{}", *text);
}

}  // namespace atrium::app::log
