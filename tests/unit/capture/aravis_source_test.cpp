#include "tests/support/comes_true.hpp"
#include "tests/unit/capture/aravis_fixture.hpp"

#include <arv.h>

#include <map>

namespace atrium::capture::test {
namespace {

using test_support::comes_true;

TEST_F(AravisSourceTest, DeliversEveryFormatByteForByte) {
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

TEST_F(AravisSourceTest, CountsDroppedPicturesWithoutFreeBuffers) {
    add_fake(fake_options(0));
    CamerasOptions options = options_of(1);
    options.num_buffers = 3;
    const auto source = open(options, 50.0);
    ASSERT_TRUE(source) << source.error().message;
    std::mutex mutex;
    std::vector<CameraFrame> held;
    Player player(**source, [&](CameraFrame frame) {
        const std::lock_guard lock(mutex);
        if (held.size() < 3) held.push_back(std::move(frame));
    });
    const auto num_dropped = [&] { return (*source)->camera_counters()[0].num_dropped; };
    ASSERT_TRUE(player.wait_for_pictures(0, 3));  // the test now holds all of the camera's buffers
    ASSERT_TRUE(comes_true([&] { return num_dropped() >= 10; }));
    EXPECT_EQ(player.count_of(0), 3u);
    const std::uint64_t least = num_dropped();
    {
        const std::lock_guard lock(mutex);
        held.pop_back();
    }
    ASSERT_TRUE(player.wait_for_pictures(0, 1));
    const auto seen = player.seen();
    const std::uint64_t num_missing = seen[3].number - seen[2].number - 1;
    EXPECT_GE(num_missing, least);
    EXPECT_LE(num_missing, num_dropped());
    for (const auto& picture : seen) EXPECT_TRUE(picture.is_exact);
}

TEST_F(AravisSourceTest, RestartedCameraReturnsWhileTheOtherContinues) {
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
    const std::size_t lost_before = player.lost().size();
    ASSERT_TRUE(player.wait_for_pictures(0, 20));
    // the assembler need not wait for the missing pictures
    EXPECT_GE(player.lost().size(), lost_before + 19);

    fakes_[1] = std::make_unique<FakeGigeCamera>(fake_options(1));
    EXPECT_TRUE(fakes_[1]->is_running());
    ASSERT_TRUE(player.wait_for_pictures(1, 3));
    ASSERT_TRUE(wait_for_event("camera 'cam1' is back"));
    // once for each loss, of which a busy machine can see more than one
    const auto num_reconnects = (*source)->camera_counters()[1].num_reconnects;
    EXPECT_GE(num_reconnects, 1u);
    EXPECT_LE(num_reconnects, num_events("camera 'cam1' is lost"));
    EXPECT_EQ((*source)->camera_counters()[0].num_reconnects, 0u);
    // the other camera never waited: no gap longer than some periods
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

TEST_F(AravisSourceTest, ReconnectsACameraThatWasSwitchedOffAndOn) {
    add_fake(fake_options(0));
    const auto source = open(options_of(1));
    ASSERT_TRUE(source) << source.error().message;
    Player player(**source);
    ASSERT_TRUE(player.wait_for_pictures(0, 3));
    fakes_[0].reset();
    // the new camera answers, but does not know the connection
    fakes_[0] = std::make_unique<FakeGigeCamera>(fake_options(0));
    // pictures of the former connection can still be on their way
    ASSERT_TRUE(wait_for_event("camera 'cam0' is back"));
    ASSERT_TRUE(player.wait_for_pictures(0, 3));
    const auto num_reconnects = (*source)->camera_counters()[0].num_reconnects;
    EXPECT_GE(num_reconnects, 1u);
    EXPECT_LE(num_reconnects, num_events("camera 'cam0' is lost"));
}

// A packet socket receives everything on its interface until its filter is set. Next to a camera
// that sends without pause, a new connection can begin with pictures of that camera.
TEST_F(AravisSourceTest, NewConnectionDeliversNoPictureOfAnotherCamera) {
    FakeGigeCamera::Options busy = fake_options(0);
    busy.first_number = 1'000'000;
    add_fake(busy);
    add_fake(fake_options(1));
    const auto source = open(options_of(2), 500.0);
    ASSERT_TRUE(source) << source.error().message;
    Player player(**source);
    for (int restart = 0; restart < 5; ++restart) {
        ASSERT_TRUE(player.wait_for_pictures(1, 3));
        const std::size_t num_returns = num_events("camera 'cam1' is back");
        fakes_[1].reset();
        fakes_[1] = std::make_unique<FakeGigeCamera>(fake_options(1));
        ASSERT_TRUE(wait_for_events("camera 'cam1' is back", num_returns + 1));
    }
    ASSERT_TRUE(player.wait_for_pictures(1, 3));
    for (const auto& seen : player.seen())
        EXPECT_EQ(seen.camera == 0, seen.number >= busy.first_number);
    EXPECT_GE((*source)->camera_counters()[1].num_reconnects, 5u);
}

TEST_F(AravisSourceTest, RejectsAndCountsPicturesThatGoBackInTime) {
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

TEST_F(AravisSourceTest, StalledConsumerGetsOnlyTheNewest) {
    FakeGigeCamera& fake = add_fake(fake_options(0));
    const auto source = open(options_of(1), 50.0);
    ASSERT_TRUE(source) << source.error().message;
    std::mutex mutex;
    std::condition_variable changed;
    bool is_stalled = true;
    std::vector<CameraFrame> held;
    Player player(**source, [&](CameraFrame frame) {
        std::unique_lock lock(mutex);
        if (held.empty()) held.push_back(std::move(frame));  // the test keeps one buffer to the end
        changed.wait(lock, [&] { return !is_stalled; });
    });
    ASSERT_TRUE(player.wait_for_pictures(0, 1));
    const std::uint64_t first = player.seen().back().number;
    // far more than the number of buffers; the counter includes the pictures of the stall
    ASSERT_TRUE(comes_true([&] { return (*source)->camera_counters()[0].num_received >= 40; }));
    const std::uint64_t before = fake.num_sent();
    {
        const std::lock_guard lock(mutex);
        is_stalled = false;
    }
    changed.notify_all();
    ASSERT_TRUE(player.wait_for_pictures(0, 3));
    const auto seen = player.seen();
    EXPECT_EQ(seen[0].number, first);
    EXPECT_GE(seen[1].number + 2, before);  // one picture may be in transit
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

TEST_F(AravisSourceTest, LostPacketsDropWholePictures) {
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
    // The source reports each incomplete picture with its expected time, unless its first packet
    // was lost.
    const auto lost = player.lost();
    EXPECT_FALSE(lost.empty());
    // Not that of a whole picture. On a busy host the fake camera sends two pictures at any
    // distance.
    for (const auto& picture : lost) {
        for (const auto& whole : player.seen())
            EXPECT_NE(picture.capture_time, whole.capture_time) << whole.number;
    }
}

}  // namespace
}  // namespace atrium::capture::test

int main(int argc, char** argv) {
    atrium::test_support::enter_own_network(10);
    testing::InitGoogleMock(&argc, argv);
    return RUN_ALL_TESTS();
}
