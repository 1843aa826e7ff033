#pragma once

#include "site_node/capture/camera_offsets.hpp"
#include "site_node/capture/metaframe.hpp"

#include <chrono>
#include <deque>
#include <limits>
#include <optional>

namespace atrium::capture {

struct AssemblerOptions {
    /// Pictures are taken less than this before or after their trigger, as their cameras say; at
    /// most a quarter of the period, so that no two triggers can be mistaken for each other.
    std::chrono::nanoseconds tolerance{};
    std::chrono::nanoseconds
        deadline{};  // after its first picture arrived, how long a metaframe may stay incomplete
    std::size_t min_cameras = 0;  // so many are enough at the deadline; 0: all are needed
};

struct AssemblerCounters {
    std::uint64_t num_complete = 0;
    std::uint64_t num_incomplete_used = 0;  // returned with enough cameras
    std::uint64_t num_incomplete = 0;       // dropped: too few, or a later one was ready
    std::uint64_t num_stray =
        0;  // single pictures: of an older trigger, of a camera twice, of no camera of the rig
};

/// Puts pictures into metaframes by their capture time, never by the order of arrival. Learns by
/// how much each camera is late as a rule, and takes that off before it compares. Not thread-safe.
class MetaframeAssembler {
public:
    MetaframeAssembler(std::size_t num_cameras, const AssemblerOptions& options);

    /// Returns the metaframe that this picture completes, or that needs not wait any longer since
    /// its other pictures are lost, else one whose deadline has passed, with enough cameras. Older
    /// ones are dropped then: newest wins. `arrival` is what deadlines are measured by; it must not
    /// decrease.
    std::optional<Metaframe> add(CameraFrame frame, std::chrono::steady_clock::time_point arrival);

    /// What no further picture has to arrive for: as `add`, but nothing is completed.
    std::optional<Metaframe> expire(std::chrono::steady_clock::time_point now);

    /// No picture will follow: what is still pending counts as past its deadline.
    std::optional<Metaframe> finish();

    const AssemblerCounters& counters() const { return counters_; }

    /// What was learned.
    const CameraOffsets& offsets() const { return offsets_; }

private:
    struct Pending {
        std::uint64_t frame_id = 0;
        Timestamp time;  // of its trigger, as the first picture says
        std::chrono::steady_clock::time_point first_arrival;
        std::vector<CameraFrame> frames;
        std::vector<std::uint8_t> is_lost;  // per camera: known not to come
        std::size_t num_present = 0;
        std::size_t num_lost = 0;
    };
    bool is_enough(const Pending& pending) const;
    void retire(Pending&& pending);
    template <typename IsDue>
    void retire_all(IsDue is_due);
    bool is_too_old(Timestamp time) const;
    Pending* find_or_open(Timestamp time, std::chrono::steady_clock::time_point arrival);
    void place(CameraFrame frame, std::chrono::steady_clock::time_point arrival);
    std::optional<Metaframe> take_ready();

    std::size_t num_cameras_;
    AssemblerOptions options_;
    CameraOffsets offsets_;
    std::deque<Pending> pending_;   // by time
    std::optional<Pending> ready_;  // newest of those that are to be returned
    Timestamp last_emitted_{std::numeric_limits<std::int64_t>::min()};
    std::uint64_t next_frame_id_ = 1;
    AssemblerCounters counters_;
};

}  // namespace atrium::capture
