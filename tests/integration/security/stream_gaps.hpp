#pragma once

#include "core/bus/messages.hpp"
#include "core/bus/status_messages.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>

/// What a listener on the site's own host misses of its meshes.
namespace atrium::test {

/// Frames of one site that did not arrive, beside those that the site dropped itself: on a machine
/// that is too slow it drops metaframes, counts them in its SiteStatus, and their numbers are
/// missing as if the network had lost them.
class StreamGaps {
public:
    /// False if a mesh is not newer than the one before.
    bool take(const bus::SiteMesh& mesh) {
        if (last_frame_ && mesh.frame_id <= *last_frame_) return false;
        if (last_frame_) num_missing_ += mesh.frame_id - *last_frame_ - 1;
        if (!last_frame_) num_dropped_before_ = num_dropped_in_all_;
        last_frame_ = mesh.frame_id;
        return true;
    }
    void take(const bus::SiteStatus& status) {
        num_dropped_in_all_ = status.num_dropped_incomplete + status.num_dropped_late +
                              status.num_failed + status.stream.num_dropped_for_rate;
        status_time_ = status.time;
    }

    std::uint64_t num_missing() const { return num_missing_; }
    /// True once the newest status covers all that was published before `time`.
    bool covers(Timestamp time) const { return status_time_ && status_time_->ns > time.ns; }
    /// Of `num_missing` frames those that the site published, by its newest status.
    std::uint64_t num_lost(std::uint64_t num_missing) const {
        return num_missing - std::min(num_missing, num_dropped_in_all_ - num_dropped_before_);
    }

private:
    std::optional<std::uint64_t> last_frame_;
    std::optional<Timestamp> status_time_;
    std::uint64_t num_missing_ = 0;
    std::uint64_t num_dropped_before_ = 0;  // the first mesh
    std::uint64_t num_dropped_in_all_ = 0;
};

}  // namespace atrium::test
