#include "site_node/refinement_pause.hpp"

#include <algorithm>
#include <utility>

namespace atrium::site_node {
namespace {

using namespace std::chrono_literals;

constexpr double kMostDropped = 0.1;  // of the metaframes since the look before
constexpr int kLooks = 3;             // a disk or another program may stop a site for a moment
constexpr auto kFirstPause = 20s;
constexpr auto kLongestPause = 320s;
constexpr auto kSteady = 60s;

}  // namespace

bool RefinementPause::look(Clock::time_point now,
                           std::uint64_t num_captured,
                           std::uint64_t num_dropped) {
    const auto captured =
        static_cast<double>(num_captured - std::exchange(num_captured_, num_captured));
    const auto dropped =
        static_cast<double>(num_dropped - std::exchange(num_dropped_, num_dropped));
    const bool is_overloaded = dropped > 0.0 && dropped >= kMostDropped * captured;
    num_overloaded_ = is_overloaded ? num_overloaded_ + 1 : 0;
    if (is_paused_) {
        if (now < ends_ || is_overloaded) return false;
        is_paused_ = false;
        ends_ = now;
        return true;
    }
    if (num_overloaded_ < kLooks) return false;
    num_overloaded_ = 0;
    const bool is_soon = has_paused_ && now - ends_ < kSteady;
    duration_ =
        is_soon ? std::min<std::chrono::seconds>(2 * duration_, kLongestPause) : kFirstPause;
    is_paused_ = has_paused_ = true;
    ends_ = now + duration_;
    return true;
}

}  // namespace atrium::site_node
