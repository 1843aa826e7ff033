// Pictures in the layouts of other programs become a recording.
#include "site_node/capture/recording_source.hpp"
#include "tests/unit/calibrate/foreign_texts.hpp"
#include "tools/calibrate/import.hpp"
#include "tools/calibrate/recording/shots.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

void write_picture(const fs::path& file, int width, int height, int grey) {
    fs::create_directories(file.parent_path());
    ASSERT_TRUE(cv::imwrite(file.string(), cv::Mat(height, width, CV_8UC3, cv::Scalar::all(grey))));
}

void write_video(const fs::path& file, int width, int height, int num_frames) {
    fs::create_directories(file.parent_path());
    cv::VideoWriter video(
        file.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25.0, {width, height});
    ASSERT_TRUE(video.isOpened());
    for (int i = 0; i < num_frames; ++i)
        video.write(cv::Mat(height, width, CV_8UC3, cv::Scalar::all(20 + 20 * i)));
}

class ImportedRecording : public testing::Test {
protected:
    void SetUp() override {
        atrium::test::Random random(21);
        cameras_ = test::random_room(random, 3);
        for (auto& camera : cameras_) {
            camera.intrinsics.width = 64;
            camera.intrinsics.height = 48;
        }
        options_.files = {folder_.write("all.yml", test::opencv_yaml(cameras_, 1000.0))};
        options_.recording = folder_.path() / "take";
        options_.output = folder_.path() / "made";
    }
    fs::path take(const std::string& name) const { return options_.recording / name; }

    // The first picture of each camera and the number of backgrounds, as a site reads them.
    void expect_recording(std::size_t num_cameras, std::size_t num_frames, int num_backgrounds) {
        const auto report = import(options_);
        ASSERT_TRUE(report) << report.error().message;
        auto source = capture::RecordingSource::open({.folder = options_.output});
        ASSERT_TRUE(source) << source.error().message;
        EXPECT_EQ((*source)->rig().cameras.size(), num_cameras);
        EXPECT_EQ((*source)->num_frames(), num_frames);
        int shown = 0;
        for (std::size_t i = 0; i < num_cameras; ++i) {
            bool is_shown = false;
            (*source)->show_background({i},
                                       [&](std::size_t, const image::YuvView&) {
                                           is_shown = true;
                                           return true;
                                       },
                                       {});
            shown += is_shown ? 1 : 0;
        }
        EXPECT_EQ(shown, num_backgrounds);
    }

    test::Folder folder_;
    test::Cameras cameras_;
    ImportOptions options_;
};

TEST_F(ImportedRecording, OfFoldersWithNumberedPicturesAndOneBackgroundEach) {
    for (int camera = 1; camera <= 3; ++camera) {
        for (int i = 100; i < 104; ++i)
            write_picture(take(fmt::format("images/cam{}/{:08}.jpg", camera, i)), 64, 48, 40);
        write_picture(take(fmt::format("background/cam{}.png", camera)), 64, 48, 10);
    }
    expect_recording(3, 4, 3);
    EXPECT_TRUE(fs::is_symlink(options_.output / "cam1/frames/000000.jpg"));
    EXPECT_TRUE(fs::is_symlink(options_.output / "cam1/background.png"));
}

TEST_F(ImportedRecording, OfVideosWithTheNumberOfTheCameraAndBackgroundVideos) {
    for (int camera = 1; camera <= 3; ++camera) {
        write_video(take(fmt::format("Trial7_Camera{}_seq.avi", camera)), 64, 48, 5);
        write_video(take(fmt::format("empty/Trial6_Camera{}_seq.avi", camera)), 64, 48, 2);
    }
    expect_recording(3, 5, 3);
    const auto rig = config::load_rig(options_.output);
    ASSERT_TRUE(rig);
    EXPECT_DOUBLE_EQ(rig->rate_hz, 25.0);
}

TEST_F(ImportedRecording, OfOneFolderWithPrefixesCopied) {
    options_.copy = true;
    options_.background = folder_.path() / "room";
    for (int camera = 1; camera <= 3; ++camera) {
        for (int i = 0; i < 3; ++i)
            write_picture(take(fmt::format("cam{}_{:04}.png", camera, i)), 64, 48, 40);
        write_picture(options_.background / fmt::format("CAM{}.JPG", camera), 64, 48, 10);
    }
    expect_recording(3, 3, 3);
    EXPECT_FALSE(fs::is_symlink(options_.output / "cam1/frames/000000.png"));
}

TEST_F(ImportedRecording, SaysWhatIsMissingAndLeavesItOut) {
    for (const int camera : {1, 3}) write_video(take(fmt::format("cam{}.avi", camera)), 64, 48, 3);
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->unsure, Contains(AllOf(HasSubstr("'cam2'"), HasSubstr("left out"))));
    EXPECT_THAT(report->unsure,
                Contains(AllOf(HasSubstr("background"), HasSubstr("--background"))));
    EXPECT_THAT(report->next, HasSubstr("--capture.source recording"));
    const auto again = import(options_);
    ASSERT_FALSE(again);
    EXPECT_THAT(again.error().message, HasSubstr("--force"));
    options_.force = true;
    EXPECT_TRUE(import(options_));
}

TEST_F(ImportedRecording, RefusesPicturesOfAnotherSizeUntilTold) {
    for (int camera = 1; camera <= 3; ++camera)
        write_video(take(fmt::format("cam{}.avi", camera)), 128, 96, 3);
    const auto report = import(options_);
    ASSERT_FALSE(report);
    EXPECT_THAT(report.error().message,
                AllOf(HasSubstr("64x48"), HasSubstr("128x96"), HasSubstr("--size 128x96")));
    options_.said.size = {128, 96};
    ASSERT_TRUE(import(options_));
    const auto rig = config::load_rig(options_.output);
    ASSERT_TRUE(rig);
    EXPECT_NEAR(rig->cameras[0].intrinsics.fx, 2.0 * cameras_[0].intrinsics.fx, 1e-9);
}

TEST_F(ImportedRecording, RefusesFoldersWithoutPicturesOfTheCameras) {
    fs::create_directories(options_.recording);
    EXPECT_THAT(import(options_).error().message, HasSubstr("neither videos nor pictures"));
    write_video(take("left.avi"), 64, 48, 1);
    EXPECT_THAT(import(options_).error().message, AllOf(HasSubstr("'cam1'"), HasSubstr("'left'")));
    write_video(take("a/cam1.avi"), 64, 48, 1);
    write_video(take("b/cam1.avi"), 64, 48, 1);
    EXPECT_THAT(import(options_).error().message, AllOf(HasSubstr("a/cam1"), HasSubstr("b/cam1")));
    options_.output = options_.recording;
    EXPECT_THAT(import(options_).error().message, HasSubstr("another -o"));
}

TEST(Likeness, GoesByNameBeforeNumber) {
    const std::vector<std::string> all{"trial3_cam1", "trial3_cam2", "trial3_cam3", "trial3_cam13"};
    EXPECT_EQ(likeness("cam1", "images/CAM1", {}), 100);
    EXPECT_EQ(likeness("cam_01", "cam1", {}), 90);
    EXPECT_EQ(likeness("cam3", "trial3_cam3", all), 80);
    EXPECT_EQ(likeness("cam3", "trial3_cam1", all), 0);
    EXPECT_EQ(likeness("3", "trial3_cam3", all), 70);
    EXPECT_EQ(likeness("3", "trial3_cam1", all), 0);
    EXPECT_EQ(likeness("Camera2", "trial3_cam2", all), 50);
    EXPECT_EQ(likeness("cam1", "trial3_cam13", all), 0);
    EXPECT_EQ(likeness("23456", "Miqus_1_23456", {"Miqus_1_23456", "Miqus_2_23457"}), 70);
}

}  // namespace
}  // namespace atrium::calibrate
