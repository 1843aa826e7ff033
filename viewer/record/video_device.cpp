#include "viewer/record/video_device.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>

namespace atrium::viewer {
namespace {

class RealDevice : public VideoDevice {
public:
    RealDevice() = default;
    RealDevice(const RealDevice&) = delete;
    RealDevice& operator=(const RealDevice&) = delete;
    ~RealDevice() override {
        if (descriptor_ >= 0) ::close(descriptor_);
    }
    int open(const char* file) override {
        descriptor_ = ::open(file, O_RDWR | O_NONBLOCK | O_CLOEXEC);
        return descriptor_ < 0 ? -1 : 0;
    }
    int control(unsigned long request, void* argument) override {
        int result = -1;
        do {
            result = ::ioctl(descriptor_, request, argument);
        } while (result < 0 && errno == EINTR);
        return result;
    }
    std::ptrdiff_t write(const std::uint8_t* bytes, std::size_t num_bytes) override {
        return ::write(descriptor_, bytes, num_bytes);
    }

private:
    int descriptor_ = -1;
};

}  // namespace

std::unique_ptr<VideoDevice> real_video_device() { return std::make_unique<RealDevice>(); }

}  // namespace atrium::viewer
