// Whole names of cameras in the names of pictures.
#include "tools/calibrate/recording/matching.hpp"

#include "tests/unit/calibrate/recording_fixture.hpp"
#include "tools/calibrate/names/name_parts.hpp"

#include <gmock/gmock.h>

namespace atrium::calibrate {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;
using testing::UnorderedElementsAre;

std::vector<Shots> videos_with(const std::vector<std::string>& labels) {
    std::vector<Shots> shots;
    for (const std::string& label : labels) shots.push_back({label + ".mp4", true, {}, label});
    return shots;
}

// Label of each camera with pictures; "error" and the message if nothing can be matched.
std::map<std::string, std::string> labels_of(const std::vector<std::string>& cameras,
                                             const std::vector<std::string>& labels) {
    const auto matches = match_shots(cameras, videos_with(labels));
    if (!matches) return {{"error", matches.error().message}};
    std::map<std::string, std::string> result;
    for (const auto& [camera, shots] : matches->by_camera) result[camera] = shots.label;
    return result;
}

// The cameras of a Panoptic Studio: panels of VGA cameras have the numbers of HD cameras as well.
const std::vector<std::string> kPanoptic{
    "00_00", "00_04", "00_11", "01_01", "01_11", "02_04", "03_07", "11_01"};

TEST(WholeNames, OfFoldersGoBeforeNumbers) {
    EXPECT_THAT(labels_of(kPanoptic, {"hdImgs/00_00", "hdImgs/00_04", "hdImgs/00_11"}),
                UnorderedElementsAre(Pair("00_00", "hdImgs/00_00"),
                                     Pair("00_04", "hdImgs/00_04"),
                                     Pair("00_11", "hdImgs/00_11")));
}

TEST(WholeNames, AreFoundAsPartsOfFileNames) {
    EXPECT_THAT(labels_of(kPanoptic, {"hdVideos/hd_00_04", "hdVideos/hd_00_11"}),
                UnorderedElementsAre(Pair("00_04", "hdVideos/hd_00_04"),
                                     Pair("00_11", "hdVideos/hd_00_11")));
}

TEST(WholeNames, OfOtherAlphabetsAreThoseInTheCalibration) {
    const Originals originals{{"cam1", "左"}, {"cam2", "前左"}, {"Tuer", "Tür"}, {"Toer", "Tör"}};
    const auto matched = [&](const std::vector<std::string>& labels) {
        std::map<std::string, std::string> result;
        const auto matches =
            match_shots({"cam1", "cam2", "Tuer", "Toer"}, videos_with(labels), originals);
        if (!matches) return std::map<std::string, std::string>{{"error", matches.error().message}};
        for (const auto& [camera, shots] : matches->by_camera) result[camera] = shots.label;
        return result;
    };
    EXPECT_THAT(matched({"左", "前左", "To\u0308r", "take TÜR"}),
                UnorderedElementsAre(Pair("cam1", "左"),
                                     Pair("cam2", "前左"),
                                     Pair("Toer", "To\u0308r"),
                                     Pair("Tuer", "take TÜR")));
    // names of the rig, where the calibration's do not occur
    EXPECT_THAT(
        matched({"左", "前左", "Toer", "Tuer"}),
        UnorderedElementsAre(
            Pair("cam1", "左"), Pair("cam2", "前左"), Pair("Toer", "Toer"), Pair("Tuer", "Tuer")));
}

// The folder 00_07 is of a camera that the calibration lacks, not of 03_07.
TEST(WholeNames, AreNotReplacedByANumberThatTwoCamerasHave) {
    EXPECT_THAT(labels_of({"00_04", "02_04", "03_07", "04_07"}, {"hd/00_04", "hd/00_07"}),
                ElementsAre(Pair("00_04", "hd/00_04")));
}

TEST(WholeNames, InsideLongerNamesAreThoseOfTheLongerOnes) {
    EXPECT_THAT(
        labels_of({"back", "left_back", "front"}, {"take_left_back", "take_back", "take_front"}),
        UnorderedElementsAre(Pair("back", "take_back"),
                             Pair("front", "take_front"),
                             Pair("left_back", "take_left_back")));
}

TEST(WholeNames, OfOneLetterFollowTheWordForACamera) {
    for (const std::string word : {"camA", "CamA", "Cam A", "camera_A", "cameraA", "Kamera-A"}) {
        std::string other = word;
        other.back() = 'B';
        const std::vector<std::string> labels{"2024-05-01-a-walk-" + word,
                                              "2024-05-01-a-walk-" + other};
        EXPECT_THAT(labels_of({"A", "B", "m", "walk", "era", "C"}, labels),
                    UnorderedElementsAre(Pair("A", labels[0]), Pair("B", labels[1])));
    }
    EXPECT_THAT(
        labels_of({"N", "S", "left"}, {"cams/t1_N", "cams/t1_S", "cams/t1_camleft"}),
        UnorderedElementsAre(
            Pair("N", "cams/t1_N"), Pair("S", "cams/t1_S"), Pair("left", "cams/t1_camleft")));
    EXPECT_THAT(labels_of({"N", "S"}, {"camN", "camS"}),
                UnorderedElementsAre(Pair("N", "camN"), Pair("S", "camS")));
    EXPECT_THAT(labels_of({"A", "A_left"}, {"camA_left", "camA"}),
                UnorderedElementsAre(Pair("A", "camA"), Pair("A_left", "camA_left")));
    EXPECT_THAT(labels_of({"m", "walk", "ama"}, {"walk_camA"}),
                testing::Not(Contains(Pair("m", "walk_camA"))));
    EXPECT_THAT(labels_of({"A", "B"}, {"calib-camA", "walk-camA", "walk-camB"}),
                ElementsAre(Pair("error", HasSubstr("'calib-camA' or 'walk-camA'"))));
}

TEST(WholeNames, DoNotTakeTheNumberOfATake) {
    EXPECT_THAT(labels_of({"3", "4"}, {"Trial 3_Miqus_1", "Trial 3_Miqus_4"}),
                ElementsAre(Pair("4", "Trial 3_Miqus_4")));
}

TEST(WholeNames, OfTwoCamerasInOneFileNameDecideNothing) {
    EXPECT_THAT(
        labels_of({"1", "2", "3"}, {"cam_1_take_3", "cam_2_take_3", "cam_3_take_3"}),
        UnorderedElementsAre(
            Pair("1", "cam_1_take_3"), Pair("2", "cam_2_take_3"), Pair("3", "cam_3_take_3")));
    EXPECT_THAT(labels_of({"1", "10"}, {"cam_1_take_10", "cam_10_take_10"}),
                UnorderedElementsAre(Pair("1", "cam_1_take_10"), Pair("10", "cam_10_take_10")));
    EXPECT_THAT(labels_of({"cam1", "cam2"}, {"a/cam1", "b/cam1", "cam2"}),
                ElementsAre(Pair("error", HasSubstr("'a/cam1' or 'b/cam1'"))));
}

TEST(WholeNames, LeaveTheRestToShortenedNames) {
    EXPECT_THAT(
        labels_of({"cam_left", "cam_right", "cam_door"}, {"t1_left", "t1_right", "t1_cam_door"}),
        UnorderedElementsAre(Pair("cam_left", "t1_left"),
                             Pair("cam_right", "t1_right"),
                             Pair("cam_door", "t1_cam_door")));
}

TEST(Likeness, KeepsNumbersApart) {
    EXPECT_LT(likeness("11_1", "01_11", {}), 90);
    EXPECT_EQ(likeness("left_back", "leftback", {}), 90);
}

TEST(NaturalOrder, CountsNumbers) {
    EXPECT_THAT(in_natural_order({"cam10", "cam2", "b", "cam02", "cam1", "a 3 b"}),
                ElementsAre("a 3 b", "b", "cam1", "cam02", "cam2", "cam10"));
}

}  // namespace

namespace test {
namespace {

TEST_F(ImportedRecording, OfAPanopticStudioTakesTheCamerasWithPictures) {
    atrium::test::Random random(22);
    cameras_ = random_room(random, 6);
    const std::vector<std::string> names{"00_00", "00_04", "00_11", "01_11", "02_04", "11_00"};
    for (std::size_t i = 0; i < names.size(); ++i) {
        cameras_[i].name = names[i];
        cameras_[i].intrinsics.width = 64;
        cameras_[i].intrinsics.height = 48;
    }
    options_.files = {folder_.write("calibration.json", opencv_json(cameras_))};
    for (const char* camera : {"00_00", "00_04", "00_11"}) {
        for (int i = 0; i < 3; ++i)
            write_picture(take(fmt::format("hdImgs/{0}/{0}_{1:08}.jpg", camera, i)), 64, 48, 40);
    }
    expect_recording(3, 3, 0);
    EXPECT_TRUE(std::filesystem::is_symlink(options_.output / "00_11/frames/000002.jpg"));
}

// More cameras than a rig has, of which some have pictures.
class LargeCalibration : public ImportedRecording {
protected:
    void SetUp() override {
        ImportedRecording::SetUp();
        atrium::test::Random random(23);
        cameras_ = random_room(random, 300);
        for (std::size_t i = 0; i < cameras_.size(); ++i) {
            cameras_[i].name = fmt::format("{:02}_{:02}", i / 24, i % 24);
            cameras_[i].intrinsics.width = 64;
            cameras_[i].intrinsics.height = 48;
        }
        options_.files = {folder_.write("calibration.json", opencv_json(cameras_))};
        for (const char* camera : {"00_01", "00_02", "03_02"})
            write_video(take(fmt::format("hd_{}.avi", camera)), 64, 48, 3);
    }
};

TEST_F(LargeCalibration, GivesTheRecordingTheCamerasWithPictures) { expect_recording(3, 3, 0); }

TEST_F(LargeCalibration, GivesTheCamerasThatTheUserNames) {
    options_.cameras = {"00_0[12]", "03_02"};
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->problems, testing::Not(Contains(HasSubstr("left out"))));
    options_.recording.clear();
    options_.output = folder_.path() / "rig.toml";
    options_.cameras = {"00_*"};
    ASSERT_TRUE(import(options_));
    EXPECT_EQ(config::load_rig(options_.output)->cameras.size(), 24U);
    options_.output = folder_.path() / "fewer.toml";
    options_.cameras = {"!00_0*", "00_*"};
    ASSERT_TRUE(import(options_));
    EXPECT_EQ(config::load_rig(options_.output)->cameras.size(), 14U);
    options_.cameras = {"!*"};
    EXPECT_THAT(import(options_).error().message,
                HasSubstr("0 cameras found as OpenCV with the names of --cameras"));
    options_.cameras = {"00_*", "99_*"};
    EXPECT_THAT(import(options_).error().message,
                HasSubstr("--cameras 99_*: no camera has this name; the calibration has 00_00, "));
}

TEST_F(LargeCalibration, IsRefusedWithTheCureWithoutEither) {
    options_.recording.clear();
    options_.output = folder_.path() / "rig.toml";
    EXPECT_THAT(import(options_).error().message,
                testing::AllOf(HasSubstr("300 cameras, but a rig has 64 at most"),
                               HasSubstr("--cameras '00*', or give --recording")));
}

}  // namespace
}  // namespace test
}  // namespace atrium::calibrate
