#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

namespace atrium::viewer {

/// The system calls that a virtual camera needs, so that tests can stand in for a device. Each
/// returns -1 and sets errno like the call it is named after.
class VideoDevice {
public:
    virtual ~VideoDevice() = default;
    virtual int open(const char* file) = 0;
    virtual int control(unsigned long request, void* argument) = 0;
    virtual std::ptrdiff_t write(const std::uint8_t* bytes, std::size_t num_bytes) = 0;
};

/// A device of this machine; closes it at the end.
std::unique_ptr<VideoDevice> real_video_device();

}  // namespace atrium::viewer
