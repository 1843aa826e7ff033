#pragma once

#include "core/base/expected.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

namespace atrium::viewer {

struct VideoFormat {
    std::filesystem::path file;  // .avi, .mkv: motion JPEG; .mp4: MPEG-4
    double fps = 10.0;
    int width = 0;  // even
    int height = 0;
};

/// Codes pictures of one size and writes them to a file. All errors are kUnavailable.
class VideoFile {
public:
    virtual ~VideoFile() = default;
    /// The picture that `write` writes from now on: width * height pixels of R, G, B, A, rows from
    /// the top.
    virtual Expected<void> set(std::span<const std::uint8_t> rgba) = 0;
    /// Writes the last picture that was set; at least one was.
    virtual Expected<void> write() = 0;
    /// Ends the file, once.
    virtual Expected<void> finish() = 0;
};

/// Begins the file; its extension chooses what it is.
Expected<std::unique_ptr<VideoFile>> create_video_file(const VideoFormat& format);

/// Motion JPEG, coded by turbojpeg and put into .avi or .mkv by libavformat: cheaper than OpenCV's
/// writer, and a picture that is shown again is coded only once.
Expected<std::unique_ptr<VideoFile>> create_jpeg_video(const VideoFormat& format);

}  // namespace atrium::viewer
