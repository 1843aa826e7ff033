// One program counts the cameras from 0, another one from 1.
#include "tools/calibrate/recording/counting.hpp"

#include "tests/unit/calibrate/recording_fixture.hpp"

#include <gmock/gmock.h>

namespace atrium::calibrate {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using testing::Pair;
using testing::UnorderedElementsAre;

std::vector<Shots> takes_with(const std::vector<std::string>& labels) {
    std::vector<Shots> shots;
    for (const std::string& label : labels) shots.push_back({label + ".avi", true, {}, label});
    return shots;
}

Originals shifted(const std::vector<std::string>& cameras, const std::vector<std::string>& labels) {
    return find_shifted_count(cameras, takes_with(labels), {}).names;
}

TEST(ShiftedCount, PairsInOrder) {
    const auto found = find_shifted_count(
        {"camera_0", "camera_1", "camera_2"},
        takes_with({"videos/session 3 Cam1", "videos/session 3 Cam2", "videos/session 3 Cam3"}),
        {});
    EXPECT_THAT(found.names,
                UnorderedElementsAre(Pair("camera_0", "camera_1"),
                                     Pair("camera_1", "camera_2"),
                                     Pair("camera_2", "camera_3")));
    EXPECT_THAT(found.pairing, HasSubstr("'camera_0' has 'videos/session 3 Cam1', 'camera_1' has"));
    EXPECT_THAT(shifted({"c09", "c10", "c11"}, {"v_8", "v_9", "v_10"}),
                UnorderedElementsAre(Pair("c09", "c08"), Pair("c10", "c09"), Pair("c11", "c10")));
    EXPECT_EQ(shifted({"cam_0", "cam_1"}, {"GX1", "GX2"}).size(), 2U);
}

TEST(ShiftedCount, NeedsEqualCountsInOneRowAndNumbersAlone) {
    EXPECT_TRUE(shifted({"a0", "a1", "a2"}, {"v0", "v1", "v2"}).empty());
    EXPECT_TRUE(shifted({"a0", "a1", "a2"}, {"v1", "v2"}).empty());
    EXPECT_TRUE(shifted({"a0", "a1", "a2"}, {"v1", "v2", "v3", "v4"}).empty());
    EXPECT_TRUE(shifted({"a0", "a1", "a3"}, {"v1", "v2", "v4"}).empty());
    EXPECT_TRUE(shifted({"a0", "a1", "a2"}, {"v2", "v3", "v4"}).empty());
    EXPECT_TRUE(shifted({"cam0", "cam1", "cam2"}, {"cam1", "cam2", "cam3"}).empty());
    EXPECT_TRUE(shifted({"a4", "a5"}, {"v5", "v6"}).empty());
    EXPECT_TRUE(shifted({"left", "right"}, {"v1", "v2"}).empty());
    // serial numbers
    EXPECT_TRUE(shifted({"26001", "26002", "26003"}, {"M26002", "M26003", "M26004"}).empty());
}

TEST(ShiftedCount, IsDoubtedIfBothEndsStickOut) {
    const std::vector<std::string> cameras{"cam0", "cam1", "cam2"};
    EXPECT_THAT(doubt_of_count(cameras, {"cam0"}, {"cam3"}),
                AllOf(HasSubstr("'cam0' has none and 'cam3' is left"),
                      HasSubstr("one program may count from 0 and the other from 1")));
    EXPECT_THAT(doubt_of_count({"cam1", "cam2"}, {"cam2"}, {"x", "cam0"}), HasSubstr("'cam2' has"));
    EXPECT_EQ(doubt_of_count(cameras, {"cam0"}, {"cam7"}), "");
    EXPECT_EQ(doubt_of_count(cameras, {"cam1"}, {"cam3"}), "");
    EXPECT_EQ(doubt_of_count({"left", "right"}, {"left"}, {"cam1"}), "");
}

class ShiftedRecording : public test::ImportedRecording {
protected:
    void SetUp() override {
        ImportedRecording::SetUp();
        for (int i = 0; i < 3; ++i)
            cameras_[static_cast<std::size_t>(i)].name = fmt::format("camera_{}", i);
        options_.files = {folder_.write("all.yml", test::opencv_yaml(cameras_, 1000.0))};
    }
};

TEST_F(ShiftedRecording, ShiftsTheEmptyRoomAsWell) {
    for (int i = 1; i <= 3; ++i)
        test::write_video(take(fmt::format("videos/session 3 Cam{}.avi", i)), 64, 48, 8);
    for (int i = 1; i <= 2; ++i)
        test::write_video(take(fmt::format("empty/session 2 Cam{}.avi", i)), 64, 48, 2);
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->checks,
                Contains(AllOf(HasSubstr("cameras: 'camera_0' has 'videos/session 3 Cam1', "),
                               HasSubstr("give the pictures the names of the cameras"))));
    EXPECT_THAT(report->problems, Not(Contains(HasSubstr("left out"))));
    const auto source_of = [&](const std::string& name) {
        return std::filesystem::read_symlink(options_.output / name).filename().string();
    };
    EXPECT_EQ(source_of("camera_0/frames.avi"), "session 3 Cam1.avi");
    EXPECT_EQ(source_of("camera_0/background.avi"), "session 2 Cam1.avi");
    EXPECT_EQ(source_of("camera_2/frames.avi"), "session 3 Cam3.avi");
    EXPECT_THAT(report->checks, Contains(HasSubstr("no empty room of 'camera_2'")));
}

TEST_F(ShiftedRecording, KeepsThePairingOfOtherCountsWithADoubt) {
    for (int i = 1; i <= 4; ++i)
        test::write_video(take(fmt::format("session 3 Cam{}.avi", i)), 64, 48, 8);
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->problems,
                Contains(AllOf(HasSubstr("1 of 3 cameras left out"),
                               HasSubstr("'camera_0' has none and 'session 3 Cam3' is left: "))));
}

}  // namespace
}  // namespace atrium::calibrate
