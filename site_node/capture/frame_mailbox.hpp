#pragma once

#include "site_node/capture/metaframe.hpp"

#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>
#include <vector>

namespace atrium::capture {

/// Passes the newest picture of each camera from the receiving threads to the assembling thread. No
/// queue: a picture not taken in time is replaced, and one older than `max_age` is discarded.
/// Thread-safe.
class FrameMailbox {
public:
    enum class Outcome { kTaken, kReplacedOne, kNobodyListens };

    FrameMailbox(std::size_t num_cameras, std::chrono::nanoseconds max_age);

    /// Stores a frame. A frame without image, which reports a lost picture, never replaces another.
    /// `arrival` is the arrival of the picture; `frame.camera` must be below `num_cameras`.
    Outcome put(CameraFrame frame, std::chrono::steady_clock::time_point arrival);

    /// Discards the pending frame of `camera`, which is gone.
    void clear(std::size_t camera);

    /// Selects the cameras whose pictures are kept: these, all or none. Discards all pending
    /// frames.
    void listen_to(const std::vector<std::size_t>& cameras);
    void listen_to_all();
    void listen_to_none();

    /// Stops keeping pictures of this camera. Pending frames of the others stay.
    void ignore(std::size_t camera);

    /// Waits for pictures and moves all pending ones to `frames`, oldest first. Returns false once
    /// a stop is requested or `timeout` passes without any. Adds the number of discarded old
    /// pictures to `num_too_old[camera]`.
    bool take(std::stop_token stop,
              std::chrono::nanoseconds timeout,
              std::vector<CameraFrame>& frames,
              std::vector<std::uint64_t>& num_too_old);

private:
    struct Slot {
        std::optional<CameraFrame> frame;
        std::chrono::steady_clock::time_point arrival;
        bool is_listened_to = false;
    };
    void listen(const std::vector<std::size_t>& only, bool all);

    std::chrono::nanoseconds max_age_;
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::vector<Slot> slots_;  // per camera
    bool has_any_ = false;
};

}  // namespace atrium::capture
