// Calibrations for pictures of another size than those of the recording.
#include "tools/calibrate/judge/other_size.hpp"

#include "tests/unit/calibrate/recording_fixture.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <utility>
#include <vector>

namespace atrium::calibrate {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// Cameras of one picture size, with principal points off the middle by up to a share of the
// picture.
test::Cameras room_of(atrium::test::Random& random,
                      int num_cameras,
                      int width,
                      int height,
                      double off_middle = 0.02) {
    test::Cameras cameras = test::random_room(random, num_cameras);
    for (auto& camera : cameras) {
        auto& k = camera.intrinsics;
        k.width = width;
        k.height = height;
        k.fx = atrium::test::between(random, 0.8, 1.4) * width;
        k.fy = k.fx;
        k.cx = (0.5 + atrium::test::between(random, -off_middle, off_middle)) * width - 0.5;
        k.cy = (0.5 + atrium::test::between(random, -off_middle, off_middle)) * height - 0.5;
    }
    return cameras;
}

TEST(OtherSize, IsFoundWhereTheWholeRigWasCalibratedAtIt) {
    const std::vector<std::pair<int, int>> sizes{
        {1600, 900}, {1280, 720}, {960, 540}, {640, 360}, {3840, 2160}};
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        atrium::test::Random random(seed);
        const bool is_good = seed % 2 == 0;  // lenses, whose ratio is exact
        test::Cameras cameras = room_of(
            random, atrium::test::between(random, 4, 12), 1920, 1080, is_good ? 0.015 : 0.05);
        EXPECT_FALSE(find_other_size(cameras)) << seed;
        const auto& [width, height] = sizes[seed / 2 % sizes.size()];
        if (!is_good && width == 1600) continue;  // a factor of 1.2 is not beyond doubt then
        for (auto& camera : cameras) {
            camera.intrinsics.width = width;
            camera.intrinsics.height = height;
        }
        const auto found = find_other_size(cameras);
        ASSERT_TRUE(found && found->size) << seed;
        EXPECT_EQ(found->num_agreeing, cameras.size()) << seed;
        EXPECT_NEAR((*found->size)[0], 1920, is_good ? 0 : 100) << seed;
        EXPECT_NEAR((*found->size)[1], 1080, is_good ? 0 : 56) << seed;
    }
}

TEST(OtherSize, NeedsNearlyAllCamerasAndOneFactor) {
    atrium::test::Random random(3);
    test::Cameras cameras = room_of(random, 6, 800, 600);
    for (auto& camera : cameras) {
        camera.intrinsics.width = 400;
        camera.intrinsics.height = 300;
    }
    auto& odd = cameras[1].intrinsics;
    odd.width = 800;
    odd.height = 600;
    const auto found = find_other_size(cameras);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->num_agreeing, 5U);
    EXPECT_FALSE(found->agrees[1]);
    EXPECT_FALSE(found->size) << "the pictures have two sizes";
    EXPECT_DOUBLE_EQ(found->factor, 2.0);
    cameras[0].intrinsics = cameras[2].intrinsics = odd;
    EXPECT_FALSE(find_other_size(cameras)) << "half of the cameras";
    // cut on one side, not scaled
    cameras = room_of(random, 6, 800, 600);
    for (auto& camera : cameras) camera.intrinsics.width = 500;
    EXPECT_FALSE(find_other_size(cameras));
    // K of millimetres, and a transposed one
    for (auto& camera : cameras) camera.intrinsics.cx = camera.intrinsics.cy = 0.0;
    EXPECT_FALSE(find_other_size(cameras));
    for (auto& camera : cameras) camera.intrinsics.cx = camera.intrinsics.cy = -0.5;
    EXPECT_FALSE(find_other_size(cameras));
    EXPECT_FALSE(find_other_size(test::Cameras(cameras.begin(), cameras.begin() + 1)));
    EXPECT_FALSE(find_other_size(test::Cameras{}));
}

// Four cameras calibrated at 128x96 px by EasyMocap, which writes no size; videos of 64x48 px.
class ScaledRecording : public testing::TestWithParam<int> {
protected:
    void SetUp() override {
        atrium::test::Random random(static_cast<std::uint64_t>(GetParam()));
        cameras_ = room_of(random, 4, 128, 96);
        intri_ = test::easymocap_intri(cameras_);
        options_.files = {folder_.write("intri.yml", intri_),
                          folder_.write("extri.yml", test::easymocap_extri(cameras_))};
        options_.recording = folder_.path() / "take";
        options_.output = folder_.path() / "made";
        options_.force = true;
        for (const auto& camera : cameras_)
            test::write_video(options_.recording / (camera.name + ".avi"), 64, 48, 3);
    }
    void expect_scaled() {
        const auto report = import(options_);
        ASSERT_TRUE(report) << report.error().message;
        EXPECT_THAT(report->problems, Not(Contains(HasSubstr("lens"))));
        EXPECT_THAT(report->checks, Not(Contains(HasSubstr("lens"))));
        const auto rig = config::load_rig(options_.output);
        ASSERT_TRUE(rig) << rig.error().message;
        for (std::size_t i = 0; i < cameras_.size(); ++i) {
            const auto& is = rig->cameras[i].intrinsics;
            const auto& was = cameras_[i].intrinsics;
            EXPECT_EQ(is.width, 64);
            EXPECT_EQ(is.height, 48);
            EXPECT_NEAR(is.fx, 0.5 * was.fx, 1e-9);
            EXPECT_NEAR(is.fy, 0.5 * was.fy, 1e-9);
            EXPECT_NEAR(is.cx + 0.5, 0.5 * (was.cx + 0.5), 1e-9);
            EXPECT_NEAR(is.cy + 0.5, 0.5 * (was.cy + 0.5), 1e-9);
        }
    }

    test::Folder folder_;
    test::Cameras cameras_;
    std::string intri_;
    ImportOptions options_;
};

INSTANTIATE_TEST_SUITE_P(Rigs, ScaledRecording, testing::Range(1, 5));

TEST_P(ScaledRecording, IsAProblemWithTheOptionThatCuresIt) {
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->problems,
                Contains(AllOf(HasSubstr("lens: the principal points of 4 of 4 cameras"),
                               HasSubstr("of about 128x96 px, but yours have 64x48 px"),
                               HasSubstr("say --calibrated-size 128x96"))));
    EXPECT_THAT(report->checks, Not(Contains(HasSubstr("principal point")))) << "said once";
    options_.said.size = {128, 96};
    EXPECT_THAT(import(options_).error().message,
                AllOf(HasSubstr("--size says 128x96"), HasSubstr("--calibrated-size 128x96")));
    options_.said.size.reset();
    options_.said.calibrated_size = {128, 96};
    expect_scaled();
    options_.said.size = {64, 48};
    expect_scaled();
    options_.said.calibrated_size = {128, 90};
    options_.said.size.reset();
    EXPECT_THAT(import(options_).error().message,
                AllOf(HasSubstr("calibrated at 128x90 px"), HasSubstr("another shape")));
}

TEST_P(ScaledRecording, WithoutPicturesTakesBothSizesFromTheUser) {
    options_.recording.clear();
    options_.output = folder_.path() / "lab.toml";
    options_.said.calibrated_size = {128, 96};
    auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(config::load_rig(options_.output)->cameras[0].intrinsics.width, 128);
    options_.said.size = {64, 48};
    expect_scaled();
}

// Also where a file says a wrong one.
TEST_P(ScaledRecording, TheSizeAtTheTopOfAFileIsThatOfAllItsCameras) {
    const std::string head = "%YAML:1.0\n---\n";
    ASSERT_TRUE(intri_.starts_with(head));
    folder_.write("intri.yml",
                  head + "image_width: 64\nimage_height: 48\n" + intri_.substr(head.size()));
    options_.said.calibrated_size = {128, 96};
    expect_scaled();
    folder_.write("intri.yml",
                  head + "image_width: 128\nimage_height: 96\n" + intri_.substr(head.size()));
    options_.said.calibrated_size.reset();
    EXPECT_THAT(import(options_).error().message,
                AllOf(HasSubstr("calibrated at 128x96 px"), HasSubstr("say --size 64x48")));
    options_.said.size = {64, 48};
    expect_scaled();
    // the corners of a board are no size
    folder_.write("intri.yml", head + "width: 9\nheight: 6\n" + intri_.substr(head.size()));
    options_.said.size.reset();
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->problems, Contains(HasSubstr("--calibrated-size 128x96")));
}

}  // namespace
}  // namespace atrium::calibrate
