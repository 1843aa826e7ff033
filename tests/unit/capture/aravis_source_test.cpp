#include "site_node/capture/aravis_source.hpp"

#include "site_node/capture/camera_discovery.hpp"
#include "tests/support/fake_gige_camera.hpp"
#include "tests/support/own_network.hpp"

#include <arv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <map>
#include <mutex>
#include <thread>

namespace atrium::capture {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test_support::FakeGigeCamera;
using testing::HasSubstr;

constexpr int kWidth = 96;
constexpr int kHeight = 64;
constexpr seconds kLongEnough{20};  // for what takes well below one, also under a sanitizer

config::Rig rig_of(std::size_t num_cameras, double rate_hz) {
    config::Rig rig;
    rig.rate_hz = rate_hz;
    for (std::size_t i = 0; i < num_cameras; ++i) {
        geometry::CalibratedCamera camera;
        camera.name = "cam" + std::to_string(i);
        camera.intrinsics.width = kWidth;
        camera.intrinsics.height = kHeight;
        rig.cameras.push_back(camera);
    }
    return rig;
}

std::string address(std::size_t camera) { return "127.0.0." + std::to_string(camera + 2); }
std::string serial(std::size_t camera) { return "S" + std::to_string(camera); }

FakeGigeCamera::Options fake_options(std::size_t camera) {
    FakeGigeCamera::Options options;
    options.address = address(camera);
    options.serial = serial(camera);
    return options;
}

CamerasOptions options_of(std::size_t num_cameras) {
    CamerasOptions options;
    for (std::size_t i = 0; i < num_cameras; ++i)
        options.cameras.push_back({"cam" + std::to_string(i), "", address(i), {}});
    options.common.pixel_format = "Mono8";
    options.trigger = TriggerMode::kFreeRun;
    options.deadline = milliseconds(100);
    options.realtime_priority = 0;
    return options;
}

// Runs a source and keeps what it delivers.
class Player {
public:
    explicit Player(AravisSource& source, FrameSource::Sink first = {})
        : first_(std::move(first)), thread_([this, &source](std::stop_token stop) {
              result_ = source.run(stop, [this](CameraFrame frame) { take(std::move(frame)); });
          }) {}

    struct Seen {
        std::size_t camera;
        std::uint64_t number;
        Timestamp capture_time;
        bool is_exact;
    };

    // False: it did not come true in time.
    template <typename Condition>
    bool wait(Condition condition, std::chrono::nanoseconds timeout = kLongEnough) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, timeout, [&] { return condition(seen_); });
    }
    /// So many more than there are now.
    bool wait_for_pictures(std::size_t camera, std::size_t more) {
        const std::size_t before = count_of(camera);
        return wait([&](const auto& seen) { return count(seen, camera) >= before + more; });
    }
    std::size_t count_of(std::size_t camera) {
        const std::lock_guard lock(mutex_);
        return count(seen_, camera);
    }
    std::vector<Seen> seen() {
        const std::lock_guard lock(mutex_);
        return seen_;
    }
    /// Those that were said to be lost.
    std::vector<Seen> lost() {
        const std::lock_guard lock(mutex_);
        return lost_;
    }
    std::optional<image::PixelFormat> format() {
        const std::lock_guard lock(mutex_);
        return format_;
    }

private:
    static std::size_t count(const std::vector<Seen>& seen, std::size_t camera) {
        return static_cast<std::size_t>(std::count_if(
            seen.begin(), seen.end(), [&](const Seen& s) { return s.camera == camera; }));
    }

    void take(CameraFrame frame) {
        if (frame.image.empty()) {
            const std::lock_guard lock(mutex_);
            lost_.push_back({frame.camera, 0, frame.capture_time, false});
            return;
        }
        const auto& plane = frame.image.planes[0];
        const std::uint64_t number = FakeGigeCamera::number_in(plane.data);
        const std::size_t row_bytes = image::row_bytes(frame.image.format, frame.image.width);
        bool is_exact = frame.image.width == kWidth && frame.image.height == kHeight &&
                        plane.stride_bytes == row_bytes;
        for (std::size_t i = sizeof(number); i < row_bytes * kHeight && is_exact; ++i)
            is_exact = plane.data[i] == FakeGigeCamera::expected_byte(number, i);
        {
            const std::lock_guard lock(mutex_);
            seen_.push_back({frame.camera, number, frame.capture_time, is_exact});
            format_ = frame.image.format;
        }
        changed_.notify_all();
        if (first_) first_(std::move(frame));
    }

    FrameSource::Sink first_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<Seen> seen_;
    std::vector<Seen> lost_;
    std::optional<image::PixelFormat> format_;
    Expected<void> result_;
    std::jthread thread_;
};

class AravisSourceTest : public testing::Test {
protected:
    void SetUp() override {
        if (const std::string& reason = test_support::reason_without_own_network();
            !reason.empty()) {
            GTEST_SKIP() << reason;
        }
    }

    FakeGigeCamera& add_fake(const FakeGigeCamera::Options& options) {
        fakes_.push_back(std::make_unique<FakeGigeCamera>(options));
        EXPECT_TRUE(fakes_.back()->is_running()) << options.address;
        return *fakes_.back();
    }

    Expected<std::unique_ptr<AravisSource>> open(const CamerasOptions& options,
                                                 double rate_hz = 20.0,
                                                 std::size_t num_cameras = 0) {
        const auto rig = rig_of(num_cameras == 0 ? options.cameras.size() : num_cameras, rate_hz);
        const auto keep = [this](bool is_warning, const std::string& line) {
            {
                const std::lock_guard lock(events_mutex_);
                events_.push_back((is_warning ? "warn " : "info ") + line);
            }
            events_changed_.notify_all();
        };
        return AravisSource::open(rig, options, keep, stop_.get_token());
    }

    bool wait_for_event(const std::string& part) {
        std::unique_lock lock(events_mutex_);
        return events_changed_.wait_for(lock, kLongEnough, [&] {
            return std::any_of(events_.begin(), events_.end(), [&](const std::string& line) {
                return line.find(part) != std::string::npos;
            });
        });
    }

    std::vector<std::unique_ptr<FakeGigeCamera>> fakes_;
    std::mutex events_mutex_;
    std::condition_variable events_changed_;
    std::vector<std::string> events_;
    std::stop_source stop_;
};

TEST_F(AravisSourceTest, PicturesOfEveryFormatArriveByteForByte) {
    const std::map<std::string, image::PixelFormat> expected{
        {"Mono8", image::PixelFormat::kMono8},
        {"BayerRG8", image::PixelFormat::kBayerRG},
        {"BayerGR8", image::PixelFormat::kBayerGR},
        {"BayerGB8", image::PixelFormat::kBayerGB},
        {"BayerBG8", image::PixelFormat::kBayerBG},
        {"RGB8", image::PixelFormat::kRgb},
        {"BGR8", image::PixelFormat::kBgr},
        {"YUV422_8", image::PixelFormat::kYuyv},
        {"YUV422_8_UYVY", image::PixelFormat::kUyvy}};
    ASSERT_EQ(expected.size(), camera_pixel_formats().size());
    add_fake(fake_options(0));
    for (const std::string& name : camera_pixel_formats()) {
        SCOPED_TRACE(name);
        CamerasOptions options = options_of(1);
        options.common.pixel_format = name;
        const auto source = open(options, 50.0);
        ASSERT_TRUE(source) << source.error().message;
        Player player(**source);
        ASSERT_TRUE(player.wait_for_pictures(0, 5));
        for (const auto& seen : player.seen()) EXPECT_TRUE(seen.is_exact) << seen.number;
        EXPECT_EQ(player.format(), expected.at(name));
    }
}

TEST_F(AravisSourceTest, SoftwareTriggersReachAllCameras) {
    for (std::size_t i = 0; i < 3; ++i) add_fake(fake_options(i));
    CamerasOptions options = options_of(3);
    options.trigger = TriggerMode::kSoftware;
    const auto source = open(options, 10.0);
    ASSERT_TRUE(source) << source.error().message;
    for (const auto& fake : fakes_) {
        EXPECT_EQ(fake->register_value(ARV_FAKE_CAMERA_REGISTER_TRIGGER_MODE), 1u);
        EXPECT_EQ(fake->register_value(ARV_FAKE_CAMERA_REGISTER_TRIGGER_SOURCE), 1u);  // software
    }
    Player player(**source);
    for (std::size_t i = 0; i < 3; ++i) ASSERT_TRUE(player.wait_for_pictures(i, 5));
    const auto seen = player.seen();
    // they look 200 times a second whether they were triggered, and would send as often by
    // themselves: at the pace of the site they send only when they are told
    std::vector<std::vector<std::int64_t>> times(3);
    for (const auto& picture : seen) times[picture.camera].push_back(picture.capture_time.ns);
    for (const auto& of_camera : times) {
        const double periods = static_cast<double>(of_camera.back() - of_camera.front()) / 100e6;
        EXPECT_NEAR(periods, static_cast<double>(of_camera.size() - 1), 1.0);
    }
}

TEST_F(AravisSourceTest, ACameraThatIsNotTriggeredIsNotLost) {
    add_fake(fake_options(0));  // nothing ever comes by its line
    CamerasOptions options = options_of(1);
    options.trigger = TriggerMode::kExternal;
    const auto source = open(options, 40.0);
    ASSERT_TRUE(source) << source.error().message;
    EXPECT_EQ(fakes_[0]->register_value(ARV_FAKE_CAMERA_REGISTER_TRIGGER_MODE), 1u);
    EXPECT_EQ(fakes_[0]->register_value(ARV_FAKE_CAMERA_REGISTER_TRIGGER_SOURCE), 0u);  // Line0
    EXPECT_TRUE(wait_for_event("camera 'cam0' is under control and sends nothing"));
    const CameraCounters counters = (*source)->camera_counters()[0];
    EXPECT_TRUE(counters.connected);
    EXPECT_EQ(counters.num_reconnects, 0u);
    EXPECT_EQ(counters.num_received, 0u);
    fakes_[0].reset();
    EXPECT_TRUE(wait_for_event("camera 'cam0' is lost"));
}

TEST_F(AravisSourceTest, ALineThatACameraLacksIsNamed) {
    add_fake(fake_options(0));
    CamerasOptions options = options_of(1);
    options.trigger = TriggerMode::kExternal;
    options.common.trigger_source = "Line7";
    const auto wrong = open(options);
    ASSERT_FALSE(wrong);
    EXPECT_EQ(wrong.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(wrong.error().message, HasSubstr("the camera refuses the source 'Line7'"));
    EXPECT_THAT(wrong.error().message, HasSubstr("it has Line0, Software"));
}

TEST_F(AravisSourceTest, ACameraWithoutFreeBuffersCountsWhatItDrops) {
    add_fake(fake_options(0));
    CamerasOptions options = options_of(1);
    options.num_buffers = 3;
    const auto source = open(options, 50.0);
    ASSERT_TRUE(source) << source.error().message;
    std::mutex mutex;
    std::vector<CameraFrame> held;
    Player player(**source, [&](CameraFrame frame) {
        const std::lock_guard lock(mutex);
        held.push_back(std::move(frame));
    });
    ASSERT_TRUE(player.wait_for_pictures(0, 3));  // all of its buffers are here now
    const std::uint64_t before = fakes_[0]->num_sent();
    while (fakes_[0]->num_sent() < before + 10) std::this_thread::yield();
    EXPECT_EQ(player.count_of(0), 3u);
    const std::uint64_t dropped = (*source)->camera_counters()[0].num_dropped;
    EXPECT_GE(dropped, 8u);
    EXPECT_LE(dropped, fakes_[0]->num_sent());
    {
        const std::lock_guard lock(mutex);
        held.clear();
    }
    EXPECT_TRUE(player.wait_for_pictures(0, 1));
    for (const auto& seen : player.seen()) EXPECT_TRUE(seen.is_exact);
    const std::lock_guard lock(mutex);
    held.clear();
}

TEST_F(AravisSourceTest, ACameraThatIsRestartedComesBackWhileTheOtherGoesOn) {
    add_fake(fake_options(0));
    add_fake(fake_options(1));
    CamerasOptions options = options_of(2);
    options.min_cameras = 1;
    const auto source = open(options);
    ASSERT_TRUE(source) << source.error().message;
    Player player(**source);
    ASSERT_TRUE(player.wait_for_pictures(0, 3));
    ASSERT_TRUE(player.wait_for_pictures(1, 3));

    fakes_[1].reset();
    ASSERT_TRUE(wait_for_event("camera 'cam1' is lost"));
    EXPECT_FALSE((*source)->camera_counters()[1].connected);
    EXPECT_TRUE((*source)->camera_counters()[0].connected);
    ASSERT_TRUE(player.wait_for_pictures(0, 20));
    EXPECT_GE(player.lost().size(), 10u);  // nobody has to wait for it

    fakes_[1] = std::make_unique<FakeGigeCamera>(fake_options(1));
    ASSERT_TRUE(fakes_[1]->is_running());
    const auto restarted = std::chrono::steady_clock::now();
    ASSERT_TRUE(player.wait_for_pictures(1, 3));
    EXPECT_LT(std::chrono::steady_clock::now() - restarted, seconds(2));
    ASSERT_TRUE(wait_for_event("camera 'cam1' is back"));
    EXPECT_EQ((*source)->camera_counters()[1].num_reconnects, 1u);
    EXPECT_EQ((*source)->camera_counters()[0].num_reconnects, 0u);
    // the other never waited: no gap of more than some periods
    const auto seen = player.seen();
    std::int64_t last_ns = 0;
    for (const auto& picture : seen) {
        if (picture.camera != 0) continue;
        if (last_ns != 0) {
            EXPECT_LT(picture.capture_time.ns - last_ns, 500'000'000);
        }
        last_ns = picture.capture_time.ns;
    }
}

TEST_F(AravisSourceTest, ACameraThatWasSwitchedOffAndOnAtOnceIsTakenBack) {
    add_fake(fake_options(0));
    const auto source = open(options_of(1));
    ASSERT_TRUE(source) << source.error().message;
    Player player(**source);
    ASSERT_TRUE(player.wait_for_pictures(0, 3));
    fakes_[0].reset();
    fakes_[0] = std::make_unique<FakeGigeCamera>(fake_options(0));  // it answers, but forgot us
    ASSERT_TRUE(player.wait_for_pictures(0, 3));
    EXPECT_EQ((*source)->camera_counters()[0].num_reconnects, 1u);
}

TEST_F(AravisSourceTest, PicturesThatAreOlderThanTheOneBeforeAreRejectedAndCounted) {
    FakeGigeCamera::Options options = fake_options(0);
    options.clock = [](std::uint64_t number, std::uint64_t host_ns) {
        return number % 4 == 0 ? host_ns - 500'000'000 : host_ns;
    };
    add_fake(options);
    const auto source = open(options_of(1), 50.0);
    ASSERT_TRUE(source) << source.error().message;
    Player player(**source);
    ASSERT_TRUE(player.wait_for_pictures(0, 20));
    Timestamp last;
    for (const auto& picture : player.seen()) {
        EXPECT_NE(picture.number % 4, 0u);
        EXPECT_GT(picture.capture_time, last);
        last = picture.capture_time;
    }
    EXPECT_GE((*source)->camera_counters()[0].num_backwards, 4u);
}

TEST_F(AravisSourceTest, AStalledConsumerSeesOnlyTheNewest) {
    FakeGigeCamera& fake = add_fake(fake_options(0));
    const auto source = open(options_of(1), 50.0);
    ASSERT_TRUE(source) << source.error().message;
    std::mutex mutex;
    std::condition_variable changed;
    bool is_stalled = true;
    std::vector<CameraFrame> held;
    Player player(**source, [&](CameraFrame frame) {
        std::unique_lock lock(mutex);
        if (held.empty()) held.push_back(std::move(frame));  // and keeps a buffer all the time
        changed.wait(lock, [&] { return !is_stalled; });
    });
    ASSERT_TRUE(player.wait_for_pictures(0, 1));
    const std::uint64_t first = player.seen().back().number;
    // far more than there are buffers; the counter is of what was received in the meantime
    while ((*source)->camera_counters()[0].num_received < 40) std::this_thread::yield();
    const std::uint64_t before = fake.num_sent();
    {
        const std::lock_guard lock(mutex);
        is_stalled = false;
    }
    changed.notify_all();
    ASSERT_TRUE(player.wait_for_pictures(0, 3));
    const auto seen = player.seen();
    EXPECT_EQ(seen[0].number, first);
    EXPECT_GE(seen[1].number + 2, before);  // one may be under way
    for (std::size_t i = 1; i < seen.size(); ++i) {
        EXPECT_GT(seen[i].number, seen[i - 1].number);
        EXPECT_TRUE(seen[i].is_exact);
    }
    EXPECT_GE((*source)->camera_counters()[0].num_late, 30u);
    const std::lock_guard lock(mutex);
    EXPECT_EQ(FakeGigeCamera::number_in(held[0].image.planes[0].data), first);
}

TEST_F(AravisSourceTest, PicturesOutliveTheSource) {
    add_fake(fake_options(0));
    std::mutex mutex;
    std::vector<CameraFrame> held;
    {
        const auto source = open(options_of(1), 50.0);
        ASSERT_TRUE(source) << source.error().message;
        Player player(**source, [&](CameraFrame frame) {
            const std::lock_guard lock(mutex);
            if (held.size() < 3) held.push_back(std::move(frame));
        });
        ASSERT_TRUE(player.wait_for_pictures(0, 4));
    }
    ASSERT_EQ(held.size(), 3u);
    for (const CameraFrame& frame : held) {
        const std::uint8_t* const data = frame.image.planes[0].data;
        const std::uint64_t number = FakeGigeCamera::number_in(data);
        for (std::size_t i = sizeof(number); i < kWidth * kHeight; ++i)
            ASSERT_EQ(data[i], FakeGigeCamera::expected_byte(number, i));
    }
}

TEST_F(AravisSourceTest, LostPacketsCostPicturesAndNoneIsStriped) {
    FakeGigeCamera::Options options = fake_options(0);
    options.lost_packets = 0.05;
    add_fake(options);
    CamerasOptions cameras = options_of(1);
    cameras.common.packet_size = 576;  // about a dozen packets per picture
    const auto source = open(cameras, 50.0);
    ASSERT_TRUE(source) << source.error().message;
    Player player(**source);
    ASSERT_TRUE(player.wait_for_pictures(0, 20));
    for (const auto& seen : player.seen()) EXPECT_TRUE(seen.is_exact) << seen.number;
    EXPECT_GT((*source)->camera_counters()[0].num_incomplete, 0u);
    // and each is told of, unless its first packet was lost, with the time that it would have had
    const auto lost = player.lost();
    EXPECT_FALSE(lost.empty());
    for (const auto& picture : lost) {
        for (const auto& whole : player.seen())
            EXPECT_GT(std::chrono::abs(picture.capture_time - whole.capture_time), milliseconds(5));
    }
}

TEST_F(AravisSourceTest, MissingCamerasAreNamedAndTakenInLater) {
    add_fake(fake_options(0));
    CamerasOptions options = options_of(3);
    const auto all = open(options);
    ASSERT_FALSE(all);
    EXPECT_EQ(all.error().kind, ErrorKind::kNotFound);
    EXPECT_THAT(all.error().message, HasSubstr("1 of 3 cameras are there, 3 are needed"));
    EXPECT_THAT(all.error().message, HasSubstr("'cam1': no camera answers at 127.0.0.3"));
    EXPECT_THAT(all.error().message, HasSubstr("'cam2'"));

    options.min_cameras = 1;
    const auto source = open(options);
    ASSERT_TRUE(source) << source.error().message;
    Player player(**source);
    ASSERT_TRUE(player.wait_for_pictures(0, 3));
    EXPECT_EQ(player.count_of(2), 0u);
    add_fake(fake_options(2));
    EXPECT_TRUE(player.wait_for_pictures(2, 3));
    EXPECT_EQ((*source)->camera_counters()[2].num_reconnects, 0u);
}

TEST_F(AravisSourceTest, CamerasAreFoundBySerialNumber) {
    add_fake(fake_options(0));
    add_fake(fake_options(1));
    CamerasOptions options = options_of(2);
    options.cameras[0] = {"cam0", serial(1), "", {}};  // the other way round
    options.cameras[1] = {"cam1", serial(0), address(0), {}};
    auto source = open(options);
    ASSERT_TRUE(source) << source.error().message;
    EXPECT_TRUE(
        wait_for_event("camera 'cam0' connected vendor=\"Aravis\" model=\"Fake\" "
                       "serial=S1 address=127.0.0.3"));
    EXPECT_TRUE(
        wait_for_event("camera 'cam1' connected vendor=\"Aravis\" model=\"Fake\" "
                       "serial=S0 address=127.0.0.2"));
    *source = nullptr;  // gives the cameras back
    options.cameras[1].serial = "S9";
    const auto wrong = open(options);
    ASSERT_FALSE(wrong);
    EXPECT_THAT(wrong.error().message,
                HasSubstr("the camera at 127.0.0.2 has serial number 'S0', not 'S9'"));
}

TEST_F(AravisSourceTest, ListsWhatIsThere) {
    add_fake(fake_options(0));
    add_fake(fake_options(1));
    const auto found = discover_cameras();
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[0].address, "127.0.0.2");
    EXPECT_EQ(found[1].serial, "S1");
    EXPECT_THAT(camera_table(found),
                HasSubstr("vendor  model  serial  address    protocol\n"
                          "Aravis  Fake   S0      127.0.0.2  GigEVision\n"));
    EXPECT_FALSE(ask_gige_camera("127.0.0.9", milliseconds(100)));
    EXPECT_FALSE(ask_gige_camera("not an address", milliseconds(100)));
}

TEST_F(AravisSourceTest, WhatACameraRefusesIsAnErrorThatNamesTheKey) {
    add_fake(fake_options(0));
    const auto error_with = [&](auto change) {
        CamerasOptions options = options_of(1);
        change(options.cameras[0].settings);
        const auto source = open(options);
        EXPECT_FALSE(source);
        if (source) return std::string();
        EXPECT_EQ(source.error().kind, ErrorKind::kConfiguration) << source.error().message;
        return source.error().message;
    };
    EXPECT_THAT(error_with([](auto& s) { s.pixel_format = "BayerRG12"; }),
                HasSubstr("'cam0': pixel_format: the camera refuses 'BayerRG12'"));
    EXPECT_THAT(error_with([](auto& s) { s.pixel_format = "Mono16"; }),
                HasSubstr("the camera sends 'Mono16'; must be one of Mono8, BayerRG8"));
    EXPECT_THAT(error_with([](auto& s) {
                    s.region_px = {0, 0, 64, 64};
                }),
                HasSubstr("region_px: is 64 x 64, the rig says 96 x 64"));
    EXPECT_THAT(error_with([](auto& s) { s.white_balance = "warm"; }), HasSubstr("white_balance"));
    EXPECT_THAT(error_with([](auto& s) { s.white_balance = "1.5,1.2"; }),
                HasSubstr("white_balance"));  // it has no BalanceRatio
    EXPECT_THAT(error_with([](auto& s) { s.packet_size = 50000; }), HasSubstr("packet_size"));
}

TEST_F(AravisSourceTest, SetsTheCameraUpAsAsked) {
    FakeGigeCamera& fake = add_fake(fake_options(0));
    CamerasOptions options = options_of(1);
    options.common.exposure_us = 1234.0;
    options.common.gain_db = 5.0;
    options.cameras[0].settings.gain_db = 7.0;  // wins
    options.common.white_balance = "auto-once";
    options.common.packet_size = 1400;
    options.cameras[0].settings.region_px = {8, 16, kWidth, kHeight};
    const auto source = open(options, 25.0);
    ASSERT_TRUE(source) << source.error().message;
    EXPECT_EQ(fake.register_value(ARV_FAKE_CAMERA_REGISTER_EXPOSURE_TIME_US), 1234u);
    EXPECT_EQ(fake.register_value(ARV_FAKE_CAMERA_REGISTER_GAIN_RAW), 7u);
    EXPECT_EQ(fake.register_value(ARV_FAKE_CAMERA_REGISTER_X_OFFSET), 8u);
    EXPECT_EQ(fake.register_value(ARV_FAKE_CAMERA_REGISTER_Y_OFFSET), 16u);
    EXPECT_EQ(fake.register_value(ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US), 40000u);
    EXPECT_EQ(fake.register_value(0x400), 1u);  // PTP, in free run
    EXPECT_EQ(fake.register_value(0x410), 1u);  // white balance once
    EXPECT_EQ(fake.register_value(0x0d04) & 0xffff, 1400u);
}

TEST_F(AravisSourceTest, PtpTimesOfSeveralCamerasAreOnOneClock) {
    // their clock is an hour ahead of the site's, and the second one takes 3 ms longer to send
    for (std::size_t i = 0; i < 2; ++i) {
        FakeGigeCamera::Options options = fake_options(i);
        options.clock = [](std::uint64_t, std::uint64_t host_ns) {
            constexpr std::uint64_t kHour_ns = 3600ull * 1'000'000'000;
            constexpr std::uint64_t kPeriod_ns = 50'000'000;  // fakes send at multiples of it
            return host_ns / kPeriod_ns * kPeriod_ns + kHour_ns;
        };
        add_fake(options);
    }
    const auto source = open(options_of(2));
    ASSERT_TRUE(source) << source.error().message;
    Player player(**source);
    ASSERT_TRUE(player.wait_for_pictures(0, 5));  // the clocks have been compared by then
    ASSERT_TRUE(player.wait_for_pictures(1, 5));
    const std::size_t before = player.seen().size();
    ASSERT_TRUE(player.wait_for_pictures(0, 10));
    ASSERT_TRUE(player.wait_for_pictures(1, 10));
    const auto seen = player.seen();
    int num_compared = 0;
    for (std::size_t i = before; i + 1 < seen.size(); ++i) {
        const auto apart_ns = std::abs(seen[i + 1].capture_time.ns - seen[i].capture_time.ns);
        if (seen[i].camera == seen[i + 1].camera || apart_ns > 25'000'000) continue;
        ++num_compared;
        EXPECT_LT(apart_ns, 100'000);  // one offset for both: what is left is its drift
    }
    EXPECT_GE(num_compared, 5);
    EXPECT_LT(std::chrono::abs(Timestamp::now() - seen.back().capture_time), seconds(1));
}

TEST_F(AravisSourceTest, ShowsTheEmptyRoomOfOneCamera) {
    add_fake(fake_options(0));
    CamerasOptions options = options_of(2);
    options.min_cameras = 1;
    options.num_background_frames = 12;
    options.common.pixel_format = "BayerRG8";
    const auto source = open(options, 50.0);
    ASSERT_TRUE(source) << source.error().message;
    std::size_t num_shown = 0;
    const auto shown = (*source)->show_background(0, [&](const image::YuvView& picture) {
        ++num_shown;
        EXPECT_EQ(picture.width(), kWidth);
        EXPECT_EQ(picture.mosaic, image::Mosaic::kRG);
    });
    ASSERT_TRUE(shown) << shown.error().message;
    EXPECT_EQ(num_shown, 12u);
    EXPECT_TRUE(wait_for_event("camera 'cam0' shows the empty room, picture 12 of 12"));
    EXPECT_EQ((*source)->camera_counters()[0].num_backwards, 0u);

    const auto missing = (*source)->show_background(1, [](const auto&) { FAIL(); });
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().kind, ErrorKind::kUnavailable);
}

TEST_F(AravisSourceTest, EntriesAndRigHaveToFit) {
    const auto message = [&](const CamerasOptions& options, std::size_t num_cameras) {
        const auto source = open(options, 20.0, num_cameras);
        return source ? std::string() : source.error().message;
    };
    EXPECT_THAT(message(options_of(1), 2), HasSubstr("none is named 'cam1', a camera of the rig"));
    EXPECT_THAT(message(options_of(3), 2), HasSubstr("the rig has no camera 'cam2'"));
    CamerasOptions twice = options_of(2);
    twice.cameras.push_back(twice.cameras[0]);
    EXPECT_THAT(message(twice, 2), HasSubstr("two are named 'cam0'"));
}

TEST_F(AravisSourceTest, AStopIsHonouredWhileCamerasAreMissing) {
    CamerasOptions options = options_of(2);
    options.cameras[1].address.clear();
    options.cameras[1].serial = "nowhere";
    add_fake(fake_options(0));
    options.min_cameras = 1;
    const auto source = open(options);
    ASSERT_TRUE(source) << source.error().message;
    const auto begin = std::chrono::steady_clock::now();
    { const Player player(**source); }
    EXPECT_LT(std::chrono::steady_clock::now() - begin, seconds(1));
}

}  // namespace
}  // namespace atrium::capture

int main(int argc, char** argv) {
    atrium::test_support::run_in_own_network(argv, 10);
    testing::InitGoogleMock(&argc, argv);
    return RUN_ALL_TESTS();
}
