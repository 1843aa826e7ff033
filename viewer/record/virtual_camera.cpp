#include "viewer/record/virtual_camera.hpp"

#include <fmt/format.h>
#include <linux/videodev2.h>
#include <opencv2/imgproc.hpp>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

namespace atrium::viewer {
namespace {

constexpr std::array<std::uint32_t, 3> kPixelFormats{
    V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_YUV420, V4L2_PIX_FMT_RGB24};
constexpr const char* kLoad =
    "sudo modprobe v4l2loopback video_nr=10 card_label=Atrium exclusive_caps=1";

std::string name_of(std::uint32_t pixel_format) {
    std::string name;
    for (unsigned shift = 0; shift < 32; shift += 8)
        name += static_cast<char>(pixel_format >> shift & 0xffU);
    return name;
}

std::size_t num_bytes(std::uint32_t pixel_format, int width, int height) {
    const auto num_pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    if (pixel_format == V4L2_PIX_FMT_YUYV) return 2 * num_pixels;
    if (pixel_format == V4L2_PIX_FMT_YUV420) return 3 * num_pixels / 2;
    return 3 * num_pixels;
}

// Bytes of a row, of the first plane where there are several.
std::uint32_t row_bytes(std::uint32_t pixel_format, int width) {
    const auto pixels = static_cast<std::uint32_t>(width);
    if (pixel_format == V4L2_PIX_FMT_YUYV) return 2 * pixels;
    return pixel_format == V4L2_PIX_FMT_YUV420 ? pixels : 3 * pixels;
}

// BT.601 video range, from the planes that OpenCV computes; two pixels share their chroma.
void pack_yuyv(const cv::Mat& i420, int width, int height, std::vector<std::uint8_t>& out) {
    const auto w = static_cast<std::size_t>(width);
    const auto h = static_cast<std::size_t>(height);
    const std::uint8_t* luma = i420.data;
    const std::uint8_t* u = luma + w * h;
    const std::uint8_t* v = u + w * h / 4;
    std::uint8_t* to = out.data();
    for (std::size_t y = 0; y < h; ++y) {
        for (std::size_t x = 0; x < w; x += 2) {
            const std::size_t chroma = y / 2 * (w / 2) + x / 2;
            *to++ = luma[y * w + x];
            *to++ = u[chroma];
            *to++ = luma[y * w + x + 1];
            *to++ = v[chroma];
        }
    }
}

}  // namespace

VirtualCamera::VirtualCamera(std::string file, std::unique_ptr<VideoDevice> device)
    : file_(std::move(file)), device_(std::move(device)) {}

tl::unexpected<Error> VirtualCamera::failed(const std::string& what) const {
    return make_error(ErrorKind::kUnavailable,
                      fmt::format("video.virtual_camera: {}: {}", file_, what));
}

Expected<std::unique_ptr<VirtualCamera>> VirtualCamera::create(
    const std::string& file, const VideoFormat& format, std::unique_ptr<VideoDevice> device) {
    std::unique_ptr<VirtualCamera> camera(new VirtualCamera(file, std::move(device)));
    if (camera->device_->open(file.c_str()) < 0) {
        const int code = errno;
        if (code == ENOENT || code == ENODEV || code == ENXIO)
            return camera->failed(
                fmt::format("there is no such device. Load the driver: {}", kLoad));
        if (code == EACCES || code == EPERM)
            return camera->failed(
                "no permission. Join its group, then log in again: "
                "sudo usermod -aG video $USER");
        if (code == EBUSY)
            return camera->failed("busy: another program writes to it. End that program");
        return camera->failed(std::strerror(code));
    }
    if (auto checked = camera->check_device(); !checked) return tl::unexpected(checked.error());
    if (auto chosen = camera->choose_format(format); !chosen) return tl::unexpected(chosen.error());
    return camera;
}

Expected<void> VirtualCamera::check_device() {
    v4l2_capability capability{};
    if (device_->control(VIDIOC_QUERYCAP, &capability) < 0)
        return failed(fmt::format("is no video device. Load one: {}", kLoad));
    const std::uint32_t can = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0
                                  ? capability.device_caps
                                  : capability.capabilities;
    if ((can & V4L2_CAP_VIDEO_OUTPUT) == 0) {
        // with exclusive_caps a loopback is a camera while a program writes to it
        const auto* card = reinterpret_cast<const char*>(capability.card);
        return failed(
            fmt::format("is no output device, but '{}': a camera, or in use. Give the "
                        "device of v4l2loopback (v4l2-ctl --list-devices), or load one: "
                        "{}",
                        std::string(card, strnlen(card, sizeof(capability.card))),
                        kLoad));
    }
    if ((can & V4L2_CAP_READWRITE) == 0)
        return failed("does not take pictures by write(), as v4l2loopback does");
    return {};
}

Expected<void> VirtualCamera::choose_format(const VideoFormat& format) {
    for (const std::uint32_t wanted : kPixelFormats) {
        v4l2_format ask{};
        ask.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
        ask.fmt.pix.width = static_cast<std::uint32_t>(format.width);
        ask.fmt.pix.height = static_cast<std::uint32_t>(format.height);
        ask.fmt.pix.pixelformat = wanted;
        ask.fmt.pix.field = V4L2_FIELD_NONE;
        ask.fmt.pix.bytesperline = row_bytes(wanted, format.width);
        ask.fmt.pix.sizeimage =
            static_cast<std::uint32_t>(num_bytes(wanted, format.width, format.height));
        ask.fmt.pix.colorspace = V4L2_COLORSPACE_SRGB;
        if (device_->control(VIDIOC_S_FMT, &ask) < 0) {
            if (errno == EBUSY)
                return failed("busy: another program writes to it. End that program");
            continue;
        }
        const v4l2_pix_format& got = ask.fmt.pix;
        const auto width = static_cast<int>(std::min<std::uint32_t>(got.width, 8192));
        const auto height = static_cast<int>(std::min<std::uint32_t>(got.height, 8192));
        const bool is_even = width > 0 && height > 0 && width % 2 == 0 && height % 2 == 0;
        const bool is_tight = got.bytesperline == 0 || got.bytesperline == row_bytes(wanted, width);
        if (got.pixelformat != wanted || !is_even || !is_tight) continue;
        pixel_format_ = wanted;
        width_ = width;
        height_ = height;
        bytes_.resize(num_bytes(wanted, width, height));
        v4l2_streamparm rate{};  // a hint for readers; not every device takes it
        rate.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
        rate.parm.output.timeperframe = {
            1000, static_cast<std::uint32_t>(std::lround(1000.0 * format.fps))};
        static_cast<void>(device_->control(VIDIOC_S_PARM, &rate));
        return {};
    }
    return failed(fmt::format(
        "takes neither YUYV, I420 nor RGB of {}x{}. Close the programs that read it, or load it "
        "again: sudo modprobe -r v4l2loopback; {}",
        format.width,
        format.height,
        kLoad));
}

std::string VirtualCamera::pixel_format() const { return name_of(pixel_format_); }

Expected<void> VirtualCamera::set(std::span<const std::uint8_t> rgba) {
    const cv::Mat picture(
        height_, width_, CV_8UC4, const_cast<std::uint8_t*>(rgba.data()));  // only read
    if (pixel_format_ == V4L2_PIX_FMT_RGB24) {
        cv::Mat rgb(height_, width_, CV_8UC3, bytes_.data());
        cv::cvtColor(picture, rgb, cv::COLOR_RGBA2RGB);
        return {};
    }
    if (pixel_format_ == V4L2_PIX_FMT_YUV420) {
        cv::Mat i420(3 * height_ / 2, width_, CV_8UC1, bytes_.data());
        cv::cvtColor(picture, i420, cv::COLOR_RGBA2YUV_I420);
        return {};
    }
    cv::Mat i420;
    cv::cvtColor(picture, i420, cv::COLOR_RGBA2YUV_I420);
    pack_yuyv(i420, width_, height_, bytes_);
    return {};
}

Expected<void> VirtualCamera::write() {
    const std::ptrdiff_t written = device_->write(bytes_.data(), bytes_.size());
    if (written >= 0) return {};
    if (errno == EAGAIN || errno == EINTR) {
        ++num_dropped_;
        return {};
    }
    return failed(fmt::format("cannot write a picture: {}", std::strerror(errno)));
}

Expected<void> VirtualCamera::finish() {
    device_.reset();
    return {};
}

}  // namespace atrium::viewer
