// Several recordings, and the empty room, in one folder.
#include "tools/calibrate/recording/takes.hpp"

#include "tests/unit/calibrate/recording_fixture.hpp"

#include <gmock/gmock.h>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

std::vector<Shots> files_with(const std::vector<std::string>& labels) {
    std::vector<Shots> shots;
    for (const std::string& label : labels) shots.push_back({label + ".avi", true, {}, label});
    return shots;
}

TEST(Takes, AreChosenByPatternOrBeginning) {
    const auto matches = [](const std::string& pattern, const std::string& label) {
        return is_of_take(pattern, label);
    };
    EXPECT_TRUE(matches("Gait 1", "Gait 1_Miqus_3"));
    EXPECT_TRUE(matches("gait 1*", "Gait 10_Miqus_3"));
    EXPECT_FALSE(matches("Gait 1", "Gait 10_Miqus_3"));
    EXPECT_FALSE(matches("Gai", "Gait 1"));
    EXPECT_TRUE(matches("take2", "videos/take2/cam1"));
    EXPECT_FALSE(matches("cam", "take2/mycam"));
    EXPECT_TRUE(matches("*_b", "cam1_b"));
}

TEST(Takes, AreProposedByTheBeginningsOfNames) {
    EXPECT_THAT(beginnings({"26001", "26002"},
                           files_with({"Gait 0001_Miqus_1_26001",
                                       "Gait 0001_Miqus_2_26002",
                                       "Gait 0012_Miqus_1_26001",
                                       "Gait 0012_Miqus_2_26002",
                                       "Jump_Miqus_1_26001",
                                       "Jump_Miqus_2_26002"})),
                ElementsAre("Gait 0001", "Gait 0012", "Jump"));
    EXPECT_THAT(
        beginnings({"cam0", "cam1"}, files_with({"v/take1/cam0", "v/take1/cam1", "v/take2/cam0"})),
        ElementsAre("take1"));
    EXPECT_THAT(beginnings({"cam0", "cam1"}, files_with({"cam0", "cam1"})), IsEmpty());
}

class SeveralTakes : public test::ImportedRecording {
protected:
    void write_take(const std::string& name) const {
        for (int camera = 1; camera <= 3; ++camera)
            test::write_video(
                take(fmt::format("{}_V{}_cam{}.avi", name, 7 - camera, camera)), 64, 48, 8);
    }
    std::string source_of(const std::string& name) const {
        return fs::read_symlink(options_.output / name).filename().string();
    }
};

TEST_F(SeveralTakes, NeedAChoice) {
    for (const char* name : {"Gait 0001", "Gait 0002", "Empty room", "Static 0001"})
        write_take(name);
    EXPECT_THAT(import(options_).error().message,
                AllOf(HasSubstr("camera 'cam1' may be 'Gait 0001_V6_cam1' or 'Gait 0002_V6_cam1'"),
                      HasSubstr("choose one recording: --take 'Gait 0001', 'Gait 0002'; or ")));
    options_.take = "Jump";
    EXPECT_THAT(
        import(options_).error().message,
        AllOf(HasSubstr("--take 'Jump': no folder and no file below "),
              HasSubstr("there are 'Empty room', 'Gait 0001', 'Gait 0002', 'Static 0001'")));
    options_.take = "Gait 0002*";
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(source_of("cam2/frames.avi"), "Gait 0002_V5_cam2.avi");
    EXPECT_EQ(source_of("cam2/background.avi"), "Empty room_V5_cam2.avi");
    EXPECT_THAT(report->told,
                Contains(HasSubstr("the empty room was found for every camera: 'Empty "
                                   "room_V6_cam1.avi' and those of 2 more cameras")));
    EXPECT_THAT(report->checks, Not(Contains(HasSubstr("static"))));
    // a static trial may be the recording
    options_.take = "Static 0001";
    options_.output = folder_.path() / "second";
    ASSERT_TRUE(import(options_));
    EXPECT_EQ(source_of("cam1/frames.avi"), "Static 0001_V6_cam1.avi");
    EXPECT_EQ(source_of("cam1/background.avi"), "Empty room_V6_cam1.avi");
}

TEST_F(SeveralTakes, AStaticTrialAsTheEmptyRoomIsDoubted) {
    write_take("Gait 0001");
    write_take("Static 0001");
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(
        report->checks,
        Contains(AllOf(HasSubstr("background: 'Static 0001_V6_cam1.avi' and those of 2 more"),
                       HasSubstr("usually shows a person"),
                       HasSubstr("--background"),
                       HasSubstr("--segmentation.background_from people"))));
    EXPECT_THAT(report->told, Not(Contains(HasSubstr("empty room was found"))));
}

TEST_F(SeveralTakes, TheRecordingIsNotItsOwnEmptyRoom) {
    write_take("Gait 0001");
    options_.background = options_.recording;
    EXPECT_THAT(import(options_).error().message,
                AllOf(HasSubstr("--background: "),
                      HasSubstr("is the folder of the recording, and no name in it says")));
    // links that lead into the recording
    options_.background = folder_.path() / "room";
    fs::create_directories(options_.background);
    for (int camera = 1; camera <= 3; ++camera) {
        fs::create_symlink(take(fmt::format("Gait 0001_V{}_cam{}.avi", 7 - camera, camera)),
                           options_.background / fmt::format("cam{}.avi", camera));
    }
    EXPECT_THAT(import(options_).error().message,
                HasSubstr("is the recording of camera 'cam1' itself"));
}

TEST_F(SeveralTakes, NeedFolders) {
    write_take("Gait 0001");
    const fs::path folder = options_.recording;
    options_.recording = folder / "Gait 0001_V6_cam1.avi";
    EXPECT_THAT(import(options_).error().message,
                HasSubstr("cam1.avi: is a file; give its folder"));
    options_.background = options_.recording;
    options_.recording = folder;
    EXPECT_THAT(import(options_).error().message,
                HasSubstr("cam1.avi: is a file; give its folder"));
}

// The recording consists of links into the folder that --background names.
TEST_F(SeveralTakes, LinksIntoTheFolderOfTheEmptyRoomAreStillTheRecording) {
    write_take("Gait 0001");
    write_take("Empty room");
    options_.background = options_.recording;
    options_.recording = folder_.path() / "links";
    fs::create_directories(options_.recording);
    for (int camera = 1; camera <= 3; ++camera) {
        const std::string name = fmt::format("Gait 0001_V{}_cam{}.avi", 7 - camera, camera);
        fs::create_symlink(options_.background / name, take(name));
    }
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(source_of("cam3/background.avi"), "Empty room_V4_cam3.avi");
}

}  // namespace
}  // namespace atrium::calibrate
