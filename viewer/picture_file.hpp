#pragma once

#include "core/base/expected.hpp"
#include "viewer/renderer/scene_renderer.hpp"
#include "viewer/video_file.hpp"

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

/// Makes its folder where that is missing and tries whether the file can be written, so that one
/// learns of it before the pictures are there. Error kUnavailable.
Expected<void> prepare_file(const std::filesystem::path& file);

/// Writes through a file of another name, so that nobody sees half a picture.
Expected<void> write_png(const std::filesystem::path& file,
                         const renderer::RenderedPicture& picture);

/// Writes a video of real time on a thread of its own.
///
/// The time since the first picture is cut into slots of 1 / `fps`; the video has one picture per
/// slot. The first picture that is offered in a slot is its own; a slot without one repeats the
/// picture before, so that the video is as long as what it shows. At most kMostWaiting pictures
/// wait for the encoder. While it is that far behind no picture is taken, which counts as dropped.
/// Ends by itself, with a file that can be played, where the disk is nearly full, and where a
/// picture cannot be coded or written.
class VideoRecorder {
public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::size_t kMostWaiting = 4;

    static Expected<std::unique_ptr<VideoRecorder>> create(const VideoFormat& format);
    ~VideoRecorder();

    /// Finishes the file, with all that was offered; once, and nothing else is called after it.
    /// Error kUnavailable where not all that was shown is in it.
    Expected<void> finish();

    /// Whether the slot of `now` wants a picture: reading one back costs. Counts a dropped picture
    /// where it does and the encoder is too far behind. On one thread, with `offer`.
    bool wants_picture(Clock::time_point now);
    /// The picture of the slot of `now`, which wants one.
    void offer(renderer::RenderedPicture picture, Clock::time_point now);
    /// A picture that was written, for its memory; an empty one where there is none.
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
    std::int64_t last_slot_ = -1;  // that had its picture, or dropped it; of the offering thread

    std::mutex mutex_;  // of the next ones
    std::condition_variable_any offered_;
    std::optional<Clock::time_point> begin_;  // when the first picture was offered
    std::deque<Entry> waiting_;               // in the order of their slots
    std::vector<renderer::RenderedPicture> spent_;
    std::jthread thread_;  // last: stops before the rest goes
};

}  // namespace atrium::viewer
