#pragma once

#include "core/base/expected.hpp"
#include "viewer/record/video_file.hpp"
#include "viewer/renderer/rendered_picture.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <vector>

namespace atrium::viewer {

/// Records a video in real time on its own thread.
///
/// Time since the first picture is divided into slots of 1 / `fps`, and the video has one picture
/// per slot: the first one offered in the slot, or else the picture before again. So the video is
/// as long as the time that it shows. A picture of another shape than the video lies between bars.
/// At most kMostWaiting pictures wait for the encoder; while the queue is full, pictures are
/// dropped and counted. The recording stops, with a playable file, when the disk is nearly full or
/// a picture cannot be encoded or written.
class VideoRecorder {
public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::size_t kMostWaiting = 4;

    /// Records into `format.file`.
    static Expected<std::unique_ptr<VideoRecorder>> create(const VideoFormat& format);
    /// Records into `target`, which is no file; only size and rate of `format` count.
    static std::unique_ptr<VideoRecorder> start(const VideoFormat& format,
                                                std::unique_ptr<VideoFile> target);
    ~VideoRecorder();

    /// Finishes the file with all pictures offered. Call it once, as the last call. Error
    /// kUnavailable if the video is incomplete.
    Expected<void> finish();

    /// Returns whether the slot of `now` needs a picture; reading one back is expensive. Counts a
    /// dropped picture if it does but the queue is full. Same thread as `offer`.
    bool wants_picture(Clock::time_point now);
    /// Takes the picture for the slot of `now`. Call it only after `wants_picture` returned true.
    void offer(renderer::RenderedPicture picture, Clock::time_point now);
    /// Returns a written picture, to reuse its memory. Empty if there is none.
    renderer::RenderedPicture spent();

    std::uint64_t num_written() const { return num_written_; }
    std::uint64_t num_dropped() const { return num_dropped_; }

private:
    struct Impl;
    struct Entry {
        std::int64_t slot = 0;
        renderer::RenderedPicture picture;
    };
    explicit VideoRecorder(std::unique_ptr<Impl> impl);
    std::int64_t slot_of(Clock::time_point time) const;
    Clock::time_point end_of(std::int64_t slot) const;
    void record(std::stop_token stop);
    bool write(const renderer::RenderedPicture& picture, std::int64_t slot);

    std::unique_ptr<Impl> impl_;
    Clock::duration period_;
    std::atomic<std::uint64_t> num_written_ = 0;
    std::atomic<std::uint64_t> num_dropped_ = 0;
    std::atomic<bool> is_disk_full_ = false;
    std::atomic<bool> has_failed_ = false;
    std::int64_t last_slot_ = -1;  // last slot with a picture or a drop; offering thread only

    std::mutex mutex_;  // guards the members below
    std::condition_variable_any offered_;
    std::optional<Clock::time_point> begin_;  // time of the first picture
    std::deque<Entry> waiting_;               // in order of slots
    std::vector<renderer::RenderedPicture> spent_;
    std::jthread thread_;  // last: stops before the other members are destroyed
};

}  // namespace atrium::viewer
