#include "viewer/receive/stale_frames.hpp"

#include <algorithm>

namespace atrium::viewer {
namespace {

// The shortest delay grows by 1 ms per second, ten times the usual clock drift.
constexpr std::int64_t kCreep = 1000;

}  // namespace

bool StaleFrames::add(const std::string& name, Timestamp delays_from, Timestamp now) {
    const std::chrono::nanoseconds delay = now - delays_from;
    const auto [found, is_new] = sites_.try_emplace(name, Site{delay, now, {}});
    Site& site = found->second;
    const auto since_last = std::max(now - site.seen, std::chrono::nanoseconds(0));
    site.best = std::min(site.best + since_last / kCreep, delay);
    site.seen = now;
    if (delay <= site.best + kMaxMore) {
        site.late_since.reset();
        return false;
    }
    if (!site.late_since || now < *site.late_since) site.late_since = now;
    if (now - *site.late_since < kGetsUsedTo) return true;
    site.best = delay;
    site.late_since.reset();
    return false;
}

}  // namespace atrium::viewer
