#pragma once

#include "core/base/expected.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

namespace atrium::viewer {

struct VideoFormat {
    std::filesystem::path file;  // .avi, .mkv: motion JPEG; .mp4: MPEG-4
    double fps = 30.0;
    int width = 0;  // even
    int height = 0;
};

/// Encodes pictures of one size and writes them to a file. All errors are kUnavailable.
class VideoFile {
public:
    virtual ~VideoFile() = default;
    /// Sets the picture for `write`: width * height pixels of R, G, B, A, top row first.
    virtual Expected<void> set(std::span<const std::uint8_t> rgba) = 0;
    /// Writes the picture last set. Call `set` at least once before.
    virtual Expected<void> write() = 0;
    /// Finishes the file. Call it once.
    virtual Expected<void> finish() = 0;
};

/// Creates the file. Its extension selects the format.
Expected<std::unique_ptr<VideoFile>> create_video_file(const VideoFormat& format);

/// Creates a motion JPEG video, encoded by turbojpeg and muxed into .avi or .mkv by libavformat.
/// Cheaper than OpenCV's writer, and encodes a repeated picture only once.
Expected<std::unique_ptr<VideoFile>> create_jpeg_video(const VideoFormat& format);

}  // namespace atrium::viewer
