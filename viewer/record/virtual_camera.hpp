#pragma once

#include "viewer/record/video_device.hpp"
#include "viewer/record/video_file.hpp"

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace atrium::viewer {

/// Writes pictures to a V4L2 output device (v4l2loopback), which other programs open as a camera.
/// The pictures are YUYV, I420 or RGB, the first that the device takes. `write` never waits.
class VirtualCamera : public VideoFile {
public:
    /// Opens `file` (/dev/videoN) and sets the format. The size is that of `format`, or the one
    /// that the device insists on: see `width`. Error kUnavailable tells why and the cure.
    static Expected<std::unique_ptr<VirtualCamera>> create(
        const std::string& file,
        const VideoFormat& format,
        std::unique_ptr<VideoDevice> device = real_video_device());

    /// Size of the pictures that `set` takes.
    int width() const { return width_; }
    int height() const { return height_; }
    std::string pixel_format() const;
    /// Pictures that the device did not take at once.
    std::uint64_t num_dropped() const { return num_dropped_; }

    Expected<void> set(std::span<const std::uint8_t> rgba) override;
    Expected<void> write() override;
    Expected<void> finish() override;

private:
    VirtualCamera(std::string file, std::unique_ptr<VideoDevice> device);
    Expected<void> check_device();
    Expected<void> choose_format(const VideoFormat& format);
    tl::unexpected<Error> failed(const std::string& what) const;

    std::string file_;
    std::unique_ptr<VideoDevice> device_;
    std::uint32_t pixel_format_ = 0;
    int width_ = 0;
    int height_ = 0;
    std::vector<std::uint8_t> bytes_;  // of the picture last set
    std::atomic<std::uint64_t> num_dropped_ = 0;
};

}  // namespace atrium::viewer
