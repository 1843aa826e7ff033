#pragma once

#include "site_node/capture/metaframe.hpp"

#include <chrono>
#include <deque>
#include <limits>
#include <optional>

namespace atrium::capture {

struct AssemblerOptions {
    std::chrono::nanoseconds
        tolerance{};  // pictures of one trigger differ by at most this; below half a period
    std::chrono::nanoseconds
        deadline{};  // after its first picture arrived, how long a metaframe may stay incomplete
};

struct AssemblerCounters {
    std::uint64_t num_complete = 0;
    std::uint64_t num_incomplete =
        0;  // dropped: a picture was missing at the deadline or when a later one was complete
    std::uint64_t num_stray =
        0;  // single pictures: of an older trigger, of a camera twice, of no camera of the rig
};

/// Puts pictures into metaframes by their capture time, never by the order of arrival. Not
/// thread-safe.
class MetaframeAssembler {
public:
    MetaframeAssembler(std::size_t num_cameras, const AssemblerOptions& options);

    /// Returns the metaframe that this picture completes. Older incomplete ones are dropped then:
    /// newest wins. `arrival` is what deadlines are measured by; it must not decrease.
    std::optional<Metaframe> add(CameraFrame frame, std::chrono::steady_clock::time_point arrival);

    /// Drops what is past its deadline.
    void expire(std::chrono::steady_clock::time_point now);

    const AssemblerCounters& counters() const { return counters_; }

private:
    struct Pending {
        std::uint64_t frame_id = 0;
        Timestamp time;
        std::chrono::steady_clock::time_point first_arrival;
        std::vector<CameraFrame> frames;
        std::size_t num_present = 0;
    };
    Pending* find_or_open(Timestamp time, std::chrono::steady_clock::time_point arrival);

    std::size_t num_cameras_;
    AssemblerOptions options_;
    std::deque<Pending> pending_;  // by time
    Timestamp last_emitted_{std::numeric_limits<std::int64_t>::min()};
    std::uint64_t next_frame_id_ = 1;
    AssemblerCounters counters_;
};

}  // namespace atrium::capture
