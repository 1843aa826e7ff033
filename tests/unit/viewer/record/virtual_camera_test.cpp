#include "viewer/record/virtual_camera.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <vector>

namespace atrium::viewer {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// What a device of v4l2loopback answers.
struct Loopback {
    int open_error = 0;
    bool is_video = true;
    std::uint32_t capabilities = V4L2_CAP_VIDEO_OUTPUT | V4L2_CAP_READWRITE;
    int format_error = 0;
    std::vector<std::uint32_t> formats{V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_YUV420, V4L2_PIX_FMT_RGB24};
    std::uint32_t fixed_width = 0;  // 0: as asked
    std::uint32_t fixed_height = 0;
    int write_error = 0;
    v4l2_pix_format format{};
    v4l2_fract period{};
    std::vector<std::vector<std::uint8_t>> pictures;
};

class FakeDevice : public VideoDevice {
public:
    explicit FakeDevice(Loopback& loopback) : loopback_(loopback) {}
    int open(const char*) override {
        return loopback_.open_error == 0 ? 0 : fail(loopback_.open_error);
    }
    int control(unsigned long request, void* argument) override {
        if (request == VIDIOC_QUERYCAP) {
            if (!loopback_.is_video) return fail(ENOTTY);
            auto& capability = *static_cast<v4l2_capability*>(argument);
            std::snprintf(reinterpret_cast<char*>(capability.card), 32, "Webcam C920");
            capability.capabilities = V4L2_CAP_DEVICE_CAPS | V4L2_CAP_VIDEO_OUTPUT;
            capability.device_caps = loopback_.capabilities;
            return 0;
        }
        if (request == VIDIOC_S_FMT) return set_format(*static_cast<v4l2_format*>(argument));
        if (request == VIDIOC_S_PARM) {
            loopback_.period = static_cast<v4l2_streamparm*>(argument)->parm.output.timeperframe;
            return 0;
        }
        return fail(ENOTTY);
    }
    std::ptrdiff_t write(const std::uint8_t* bytes, std::size_t num_bytes) override {
        if (loopback_.write_error != 0) return fail(loopback_.write_error);
        loopback_.pictures.emplace_back(bytes, bytes + num_bytes);
        return static_cast<std::ptrdiff_t>(num_bytes);
    }

private:
    static int fail(int code) {
        errno = code;
        return -1;
    }
    int set_format(v4l2_format& format) {
        if (loopback_.format_error != 0) return fail(loopback_.format_error);
        v4l2_pix_format& pix = format.fmt.pix;
        EXPECT_EQ(format.type, static_cast<std::uint32_t>(V4L2_BUF_TYPE_VIDEO_OUTPUT));
        // like the driver, another format than asked is no error
        if (std::find(loopback_.formats.begin(), loopback_.formats.end(), pix.pixelformat) ==
            loopback_.formats.end()) {
            pix.pixelformat = V4L2_PIX_FMT_GREY;
        }
        if (loopback_.fixed_width > 0) {
            pix.width = loopback_.fixed_width;
            pix.height = loopback_.fixed_height;
            pix.bytesperline = 0;
        }
        loopback_.format = pix;
        return 0;
    }

    Loopback& loopback_;
};

Expected<std::unique_ptr<VirtualCamera>> open_camera(Loopback& loopback) {
    return VirtualCamera::create("/dev/video10",
                                 {.file = {}, .fps = 25.0, .width = 4, .height = 2},
                                 std::make_unique<FakeDevice>(loopback));
}

// Left half red, right half grey.
std::vector<std::uint8_t> two_colours() {
    std::vector<std::uint8_t> rgba;
    for (int y = 0; y < 2; ++y) {
        rgba.insert(rgba.end(), {255, 0, 0, 255, 255, 0, 0, 255});
        rgba.insert(rgba.end(), {128, 128, 128, 255, 128, 128, 128, 255});
    }
    return rgba;
}

TEST(VirtualCamera, WritesTheFirstFormatThatTheDeviceTakes) {
    Loopback loopback;
    auto camera = open_camera(loopback);
    ASSERT_TRUE(camera) << camera.error().message;
    EXPECT_EQ((*camera)->pixel_format(), "YUYV");
    EXPECT_EQ(loopback.period.denominator, 25 * loopback.period.numerator);
    ASSERT_TRUE((*camera)->set(two_colours()));
    ASSERT_TRUE((*camera)->write());
    ASSERT_TRUE((*camera)->write());
    ASSERT_EQ(loopback.pictures.size(), 2u);
    ASSERT_EQ(loopback.pictures[0].size(), 16u);
    EXPECT_EQ(loopback.format.sizeimage, 16u);
    const auto& p = loopback.pictures[0];
    EXPECT_NEAR(p[0], 81, 2);  // BT.601: red is Y 81, U 90, V 240
    EXPECT_NEAR(p[1], 90, 2);
    EXPECT_NEAR(p[3], 240, 2);
    EXPECT_NEAR(p[4], 126, 2);  // grey
    EXPECT_NEAR(p[5], 128, 2);
    EXPECT_NEAR(p[7], 128, 2);
}

TEST(VirtualCamera, WritesPlanesOrRgbWhereTheDeviceWantsThem) {
    Loopback planes;
    planes.formats = {V4L2_PIX_FMT_YUV420, V4L2_PIX_FMT_RGB24};
    auto camera = open_camera(planes);
    ASSERT_TRUE(camera) << camera.error().message;
    EXPECT_EQ((*camera)->pixel_format(), "YU12");
    ASSERT_TRUE((*camera)->set(two_colours()));
    ASSERT_TRUE((*camera)->write());
    ASSERT_EQ(planes.pictures.at(0).size(), 12u);
    EXPECT_NEAR(planes.pictures[0][0], 81, 2);
    EXPECT_NEAR(planes.pictures[0][10], 240, 2);  // V of the left half
    Loopback rgb;
    rgb.formats = {V4L2_PIX_FMT_RGB24};
    camera = open_camera(rgb);
    ASSERT_TRUE(camera) << camera.error().message;
    ASSERT_TRUE((*camera)->set(two_colours()));
    ASSERT_TRUE((*camera)->write());
    ASSERT_EQ(rgb.pictures.at(0).size(), 24u);
    EXPECT_EQ(rgb.pictures[0][0], 255);
    EXPECT_EQ(rgb.pictures[0][6], 128);
}

TEST(VirtualCamera, TakesTheSizeThatTheDeviceInsistsOn) {
    Loopback loopback;
    loopback.fixed_width = 8;
    loopback.fixed_height = 4;
    const auto camera = open_camera(loopback);
    ASSERT_TRUE(camera) << camera.error().message;
    EXPECT_EQ((*camera)->width(), 8);
    EXPECT_EQ((*camera)->height(), 4);
}

TEST(VirtualCamera, TellsEveryFaultAndItsCure) {
    const auto message = [](Loopback loopback) {
        const auto camera = open_camera(loopback);
        EXPECT_FALSE(camera);
        return camera ? std::string() : camera.error().message;
    };
    Loopback missing;
    missing.open_error = ENOENT;
    EXPECT_THAT(message(missing),
                AllOf(HasSubstr("video.virtual_camera: /dev/video10: there is no such device"),
                      HasSubstr("modprobe v4l2loopback")));
    Loopback forbidden;
    forbidden.open_error = EACCES;
    EXPECT_THAT(message(forbidden), AllOf(HasSubstr("no permission"), HasSubstr("usermod")));
    Loopback busy;
    busy.open_error = EBUSY;
    EXPECT_THAT(message(busy), HasSubstr("busy"));
    busy = Loopback{};
    busy.format_error = EBUSY;
    EXPECT_THAT(message(busy), HasSubstr("busy"));
    Loopback file;
    file.is_video = false;
    EXPECT_THAT(message(file), HasSubstr("is no video device"));
    Loopback webcam;
    webcam.capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
    EXPECT_THAT(message(webcam), AllOf(HasSubstr("is no output device, but 'Webcam C920'")));
    Loopback strange;
    strange.formats = {};
    EXPECT_THAT(message(strange), HasSubstr("takes neither YUYV, I420 nor RGB of 4x2"));
}

TEST(VirtualCamera, RealDevicesAreOpenedAndRefused) {
    const VideoFormat format{.file = {}, .fps = 25.0, .width = 4, .height = 2};
    const auto missing = VirtualCamera::create("/dev/atrium_none", format);
    ASSERT_FALSE(missing);
    EXPECT_THAT(missing.error().message, HasSubstr("there is no such device"));
    const auto null = VirtualCamera::create("/dev/null", format);
    ASSERT_FALSE(null);
    EXPECT_THAT(null.error().message, HasSubstr("is no video device"));
}

TEST(VirtualCamera, APictureThatTheDeviceDoesNotTakeIsCounted) {
    Loopback loopback;
    auto camera = open_camera(loopback);
    ASSERT_TRUE(camera);
    ASSERT_TRUE((*camera)->set(two_colours()));
    loopback.write_error = EAGAIN;
    EXPECT_TRUE((*camera)->write());
    EXPECT_EQ((*camera)->num_dropped(), 1u);
    loopback.write_error = ENODEV;
    const auto gone = (*camera)->write();
    ASSERT_FALSE(gone);
    EXPECT_THAT(gone.error().message, HasSubstr("cannot write a picture"));
}

}  // namespace
}  // namespace atrium::viewer
