#pragma once

#include "site_node/capture/camera_offsets.hpp"
#include "site_node/capture/metaframe.hpp"

#include <chrono>
#include <deque>
#include <limits>
#include <optional>

namespace atrium::capture {

struct AssemblerOptions {
    /// Largest difference between the capture time of a picture and its trigger. At most a quarter
    /// of the period: then no two triggers can be confused.
    std::chrono::nanoseconds tolerance{};
    /// How long a metaframe may stay incomplete after the arrival of its first picture.
    std::chrono::nanoseconds deadline{};
    std::size_t min_cameras = 0;  // enough at the deadline; 0: all are needed
};

struct AssemblerCounters {
    std::uint64_t num_complete = 0;
    std::uint64_t num_incomplete_used = 0;  // returned with enough cameras
    std::uint64_t num_incomplete = 0;       // dropped: too few cameras, or a later one was ready
    /// Single pictures of an older trigger, of a camera already present, or of no camera of the
    /// rig.
    std::uint64_t num_stray = 0;
};

/// Groups pictures into metaframes by capture time, never by order of arrival. Learns the usual
/// delay of each camera and subtracts it before it compares. Not thread-safe.
class MetaframeAssembler {
public:
    MetaframeAssembler(std::size_t num_cameras, const AssemblerOptions& options);

    /// Adds a picture. Returns the metaframe that it completes, or one whose other pictures are
    /// known to be lost; else one past its deadline with enough cameras. Drops all older
    /// metaframes: newest wins. `arrival` drives the deadlines and must not decrease.
    std::optional<Metaframe> add(CameraFrame frame, std::chrono::steady_clock::time_point arrival);

    /// Like `add`, but only checks the deadlines.
    std::optional<Metaframe> expire(std::chrono::steady_clock::time_point now);

    /// Returns the earliest time at which `expire` ends a metaframe; empty if none is pending.
    std::optional<std::chrono::steady_clock::time_point> next_expiry() const;

    /// Ends the input: every pending metaframe counts as past its deadline.
    std::optional<Metaframe> finish();

    const AssemblerCounters& counters() const { return counters_; }

    /// The learned offsets.
    const CameraOffsets& offsets() const { return offsets_; }

private:
    struct Pending {
        std::uint64_t frame_id = 0;
        Timestamp time;  // trigger time, from its first picture
        std::chrono::steady_clock::time_point first_arrival;
        std::vector<CameraFrame> frames;
        std::vector<std::uint8_t> is_lost;  // per camera: known to be lost
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
    void note_age(Timestamp time);

    std::size_t num_cameras_;
    AssemblerOptions options_;
    CameraOffsets offsets_;
    std::deque<Pending> pending_;   // sorted by time
    std::optional<Pending> ready_;  // newest metaframe to return
    Timestamp last_emitted_{std::numeric_limits<std::int64_t>::min()};
    std::size_t num_far_too_old_ = 0;  // pictures in a row
    std::uint64_t next_frame_id_ = 1;
    AssemblerCounters counters_;
};

}  // namespace atrium::capture
