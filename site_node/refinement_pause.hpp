#pragma once

#include <chrono>
#include <cstdint>

namespace atrium::site_node {

/// Decides when a site goes without the refinement of the hull from pictures, because its host is
/// too slow: whole metaframes are worth more.
///
/// A pause begins after three looks in a row at which a tenth or more of the new metaframes had
/// been dropped. It lasts 20 seconds, and goes on while metaframes are dropped without the
/// refinement, too. The next one lasts twice as long, up to 320 seconds, if it begins less than a
/// minute after the end of the one before.
class RefinementPause {
public:
    using Clock = std::chrono::steady_clock;

    /// Call once a second. Takes the metaframes that came since the start, and how many of them
    /// were dropped since newer ones came before their turn. True: a pause began or ended.
    bool look(Clock::time_point now, std::uint64_t num_captured, std::uint64_t num_dropped);

    bool is_paused() const { return is_paused_; }
    /// Of the pause that began last.
    std::chrono::seconds duration() const { return duration_; }

private:
    std::uint64_t num_captured_ = 0;  // at the look before
    std::uint64_t num_dropped_ = 0;
    int num_overloaded_ = 0;  // looks in a row
    bool is_paused_ = false;
    bool has_paused_ = false;
    std::chrono::seconds duration_{0};
    Clock::time_point ends_;
};

}  // namespace atrium::site_node
