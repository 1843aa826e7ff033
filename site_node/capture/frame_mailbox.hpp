#pragma once

#include "site_node/capture/metaframe.hpp"

#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>
#include <vector>

namespace atrium::capture {

/// The newest picture of each camera, on its way from the threads that receive them to the one that
/// assembles. Nothing queues: a picture that was not taken is replaced, and one that has become
/// older than `max_age` by then is not handed out. Thread-safe.
class FrameMailbox {
public:
    enum class Outcome { kTaken, kReplacedOne, kNobodyListens };

    FrameMailbox(std::size_t num_cameras, std::chrono::nanoseconds max_age);

    /// A frame without a picture, which says that one is lost, never replaces another. `arrival` is
    /// when the picture came in; `frame.camera` must be below `num_cameras`.
    Outcome put(CameraFrame frame, std::chrono::steady_clock::time_point arrival);

    /// Forgets what `camera` has delivered: it is gone.
    void clear(std::size_t camera);

    /// From now on pictures of these cameras are kept, of no camera, or of all; what was there is
    /// forgotten.
    void listen_to(const std::vector<std::size_t>& cameras);
    void listen_to_all();
    void listen_to_none();

    /// The same for all but this one, which is no longer listened to; their pictures stay.
    void ignore(std::size_t camera);

    /// Waits for pictures and moves all that are there to `frames`, oldest first; false once a stop
    /// is requested or `timeout` has passed without any. `num_too_old[camera]` grows by those that
    /// were left out.
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
