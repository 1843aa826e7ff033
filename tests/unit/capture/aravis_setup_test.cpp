#include "site_node/capture/camera_discovery.hpp"
#include "tests/unit/capture/aravis_fixture.hpp"

#include <arv.h>

#include <array>

namespace atrium::capture::test {
namespace {

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
    // The fakes check for triggers 200 times a second, and in free run they would send as often.
    // They send at the pace of the site only if triggers make them send.
    std::vector<std::vector<std::int64_t>> times(3);
    for (const auto& picture : seen) times[picture.camera].push_back(picture.capture_time.ns);
    for (const auto& of_camera : times) {
        const double periods = static_cast<double>(of_camera.back() - of_camera.front()) / 100e6;
        // a busy machine makes the site skip triggers
        EXPECT_LE(static_cast<double>(of_camera.size() - 1), periods + 1.0);
    }
}

// Aravis repeats an unanswered trigger for some seconds. The other camera must not wait.
TEST_F(AravisSourceTest, DeadTriggeredCameraIsReportedAndDelaysNoOther) {
    for (std::size_t i = 0; i < 2; ++i) add_fake(fake_options(i));
    CamerasOptions options = options_of(2);
    options.trigger = TriggerMode::kSoftware;
    const auto source = open(options, 20.0);
    ASSERT_TRUE(source) << source.error().message;
    Player player(**source);
    for (std::size_t i = 0; i < 2; ++i) ASSERT_TRUE(player.wait_for_pictures(i, 5));
    fakes_[1].reset();
    ASSERT_TRUE(wait_for_event("camera 'cam1' does not answer for"));
    const std::size_t lost_before = player.lost().size();
    ASSERT_TRUE(player.wait_for_pictures(0, 10));
    EXPECT_GE(player.lost().size(), lost_before + 5);
    ASSERT_TRUE(wait_for_event("camera 'cam1' is lost"));
}

TEST_F(AravisSourceTest, UntriggeredCameraIsNotLost) {
    add_fake(fake_options(0));  // no trigger ever arrives on its line
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

TEST_F(AravisSourceTest, NamesATriggerLineThatACameraLacks) {
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

TEST_F(AravisSourceTest, MissingCamerasAreNamedAndJoinLater) {
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

TEST_F(AravisSourceTest, FindsCamerasBySerialNumber) {
    add_fake(fake_options(0));
    add_fake(fake_options(1));
    CamerasOptions options = options_of(2);
    options.cameras[0] = {"cam0", serial(1), "", {}};  // in swapped order
    options.cameras[1] = {"cam1", serial(0), address(0), {}};
    auto source = open(options);
    ASSERT_TRUE(source) << source.error().message;
    EXPECT_TRUE(
        wait_for_event("camera 'cam0' connected vendor=\"Aravis\" model=\"Fake\" "
                       "serial=S1 address=127.0.0.3"));
    EXPECT_TRUE(
        wait_for_event("camera 'cam1' connected vendor=\"Aravis\" model=\"Fake\" "
                       "serial=S0 address=127.0.0.2"));
    *source = nullptr;  // releases the cameras
    options.cameras[1].serial = "S9";
    const auto wrong = open(options);
    ASSERT_FALSE(wrong);
    EXPECT_THAT(wrong.error().message,
                HasSubstr("the camera at 127.0.0.2 has serial number 'S0', not 'S9'"));
}

TEST_F(AravisSourceTest, ListsCamerasOnTheNetwork) {
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

TEST_F(AravisSourceTest, RefusedSettingIsAnErrorThatNamesTheKey) {
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
                HasSubstr("region_px: is 64 x 64, but the rig needs 96 x 64"));
    EXPECT_THAT(error_with([](auto& s) { s.white_balance = "warm"; }), HasSubstr("white_balance"));
    EXPECT_THAT(error_with([](auto& s) { s.white_balance = "1.5,1.2"; }),
                HasSubstr("white_balance"));  // the fake has no BalanceRatio
    EXPECT_THAT(error_with([](auto& s) { s.packet_size = 50000; }), HasSubstr("packet_size"));
}

TEST_F(AravisSourceTest, AppliesTheSettings) {
    FakeGigeCamera& fake = add_fake(fake_options(0));
    CamerasOptions options = options_of(1);
    options.common.exposure_us = 1234.0;
    options.common.gain_db = 5.0;
    options.cameras[0].settings.gain_db = 7.0;  // overrides the common value
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

TEST_F(AravisSourceTest, PtpTimesOfAllCamerasShareOneClock) {
    // The clock of the cameras is an hour ahead of the site's. The second camera sends 3 ms later.
    for (std::size_t i = 0; i < 2; ++i) {
        FakeGigeCamera::Options options = fake_options(i);
        options.clock = [i](std::uint64_t, std::uint64_t host_ns) {
            if (i == 1) std::this_thread::sleep_for(milliseconds(3));
            constexpr std::uint64_t kHour_ns = 3600ull * 1'000'000'000;
            constexpr std::uint64_t kPeriod_ns = 50'000'000;  // fakes send at multiples of it
            return host_ns / kPeriod_ns * kPeriod_ns + kHour_ns;
        };
        add_fake(options);
    }
    const auto source = open(options_of(2));
    ASSERT_TRUE(source) << source.error().message;
    Player player(**source);
    ASSERT_TRUE(player.wait_for_pictures(0, 5));  // by now the clocks are compared
    ASSERT_TRUE(player.wait_for_pictures(1, 5));
    const std::size_t before = player.seen().size();
    ASSERT_TRUE(player.wait_for_pictures(0, 10));
    ASSERT_TRUE(player.wait_for_pictures(1, 10));
    const auto seen = player.seen();
    std::vector<std::int64_t> distances_ns;
    for (std::size_t i = before; i + 1 < seen.size(); ++i) {
        const auto apart_ns = std::abs(seen[i + 1].capture_time.ns - seen[i].capture_time.ns);
        if (seen[i].camera == seen[i + 1].camera || apart_ns > 25'000'000) continue;
        distances_ns.push_back(apart_ns);
    }
    ASSERT_GE(distances_ns.size(), 5u);
    // Both cameras have one offset, so only its drift is left. When a picture arrives faster than
    // any before it, as after a load peak, the offset shrinks by the difference.
    const auto median = distances_ns.begin() + static_cast<std::ptrdiff_t>(distances_ns.size() / 2);
    std::nth_element(distances_ns.begin(), median, distances_ns.end());
    EXPECT_LT(*median, 100'000);
    EXPECT_LT(std::chrono::abs(Timestamp::now() - seen.back().capture_time), seconds(1));
}

TEST_F(AravisSourceTest, ShowsTheEmptyRoomOfAllCamerasInParallel) {
    add_fake(fake_options(0));
    add_fake(fake_options(1));
    CamerasOptions options = options_of(3);
    options.min_cameras = 1;
    options.common.pixel_format = "BayerRG8";
    const auto source = open(options, 50.0);
    ASSERT_TRUE(source) << source.error().message;
    EXPECT_TRUE((*source)->is_live());
    const std::array<int, 3> wanted{12, 30, 1};
    std::array<int, 3> num_shown{};
    int num_of_first_when_second_began = -1;
    const auto look = [&](std::size_t camera, const image::YuvView& picture) {
        EXPECT_EQ(picture.width(), kWidth);
        EXPECT_EQ(picture.mosaic, image::Mosaic::kRG);
        if (camera == 1 && num_shown[1] == 0) num_of_first_when_second_began = num_shown[0];
        return ++num_shown[camera] < wanted[camera];
    };
    const auto shown = (*source)->show_background({0, 1, 2}, look, {});
    ASSERT_EQ(shown.size(), 3u);
    EXPECT_TRUE(shown[0]) << shown[0].error().message;
    EXPECT_TRUE(shown[1]) << shown[1].error().message;
    // each camera shows exactly as many as wanted
    EXPECT_THAT(num_shown, testing::ElementsAre(12, 30, 0));
    EXPECT_LT(num_of_first_when_second_began, 12);
    EXPECT_EQ((*source)->camera_counters()[0].num_backwards, 0u);
    ASSERT_FALSE(shown[2]);  // camera 2 is absent, and the others continue
    EXPECT_EQ(shown[2].error().kind, ErrorKind::kUnavailable);
}

TEST_F(AravisSourceTest, StopEndsTheEmptyRoomAtOnce) {
    add_fake(fake_options(0));
    add_fake(fake_options(1));
    const auto source = open(options_of(2));
    ASSERT_TRUE(source) << source.error().message;
    std::stop_source stop;
    std::array<int, 2> num_shown{};
    int num_at_stop = 0;
    const auto look = [&](std::size_t camera, const image::YuvView&) {
        ++num_shown[camera];
        if (camera == 1) return num_shown[1] < 2;
        if (num_shown[1] < 2) return true;  // the other one is not done yet
        num_at_stop = num_shown[0];
        stop.request_stop();
        return true;
    };
    const auto shown = (*source)->show_background({0, 1}, look, stop.get_token());
    ASSERT_EQ(shown.size(), 2u);
    ASSERT_FALSE(shown[0]);
    EXPECT_EQ(shown[0].error().kind, ErrorKind::kUnavailable);
    EXPECT_EQ(num_shown[0], num_at_stop) << "no picture comes after the stop";
    EXPECT_TRUE(shown[1]) << "a camera that was done before the stop stays done";
    EXPECT_EQ(num_shown[1], 2);
}

TEST_F(AravisSourceTest, CameraEntriesMustMatchTheRig) {
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

TEST_F(AravisSourceTest, StopEndsTheWaitForMissingCameras) {
    CamerasOptions options = options_of(2);
    options.cameras[1].address.clear();
    options.cameras[1].serial = "nowhere";
    add_fake(fake_options(0));
    options.min_cameras = 1;
    const auto source = open(options);
    ASSERT_TRUE(source) << source.error().message;
    const auto begin = std::chrono::steady_clock::now();
    { const Player player(**source); }
    // without the stop it would ask for the camera every second
    EXPECT_LT(std::chrono::steady_clock::now() - begin, seconds(1));
}

}  // namespace
}  // namespace atrium::capture::test
