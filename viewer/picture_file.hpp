#pragma once

#include "core/base/expected.hpp"
#include "core/base/latest_slot.hpp"
#include "viewer/renderer/scene_renderer.hpp"

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <stop_token>
#include <thread>

namespace atrium::viewer {

/// Makes its folder where that is missing and tries whether the file can be written, so that one
/// learns of it before the pictures are there. Error kUnavailable.
Expected<void> prepare_file(const std::filesystem::path& file);

/// Writes through a file of another name, so that nobody sees half a picture.
Expected<void> write_png(const std::filesystem::path& file,
                         const renderer::RenderedPicture& picture);

struct VideoFormat {
    std::filesystem::path file;  // .avi, .mkv: motion JPEG; .mp4: MPEG-4
    double fps = 10.0;
    int width = 0;  // even
    int height = 0;
};

/// Writes a video of real time in a thread of its own: `fps` pictures per second, of whatever was
/// shown last. A picture that comes while the last one waits replaces it. Ends by itself, with a
/// file that can be played, where the disk is nearly full.
class VideoRecorder {
public:
    static Expected<std::unique_ptr<VideoRecorder>> create(const VideoFormat& format);
    ~VideoRecorder();

    /// Finishes the file; once, and nothing else is called after it. Error kUnavailable where not
    /// all that was shown is in it.
    Expected<void> finish();

    /// Whether it is time for the next picture: reading one back costs.
    bool wants_picture() const;
    void offer(renderer::RenderedPicture picture);
    std::uint64_t num_written() const { return num_written_; }

private:
    struct Impl;
    explicit VideoRecorder(std::unique_ptr<Impl> impl);
    void record(std::stop_token stop);

    std::unique_ptr<Impl> impl_;
    LatestSlot<renderer::RenderedPicture> slot_;
    std::atomic<bool> wants_picture_ = true;
    std::atomic<std::uint64_t> num_written_ = 0;
    std::atomic<bool> is_disk_full_ = false;
    std::jthread thread_;  // last: stops before the rest goes
};

}  // namespace atrium::viewer
