// Pictures in the layouts of other programs become a recording.
#include "tests/unit/calibrate/recording_fixture.hpp"
#include "tools/calibrate/formats/format.hpp"
#include "tools/calibrate/recording/codec_rate.hpp"
#include "tools/calibrate/recording/matching.hpp"

#include <gmock/gmock.h>

#include <fstream>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

using test::ImportedRecording;
using test::write_picture;
using test::write_video;

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
    options_.programs = "some/bin/";
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->problems,
                Contains(AllOf(HasSubstr("1 of 3 cameras left out"), HasSubstr("'cam2'"))));
    EXPECT_THAT(report->problems,
                Contains(AllOf(HasSubstr("3 pictures per camera is too few"),
                               HasSubstr("--background"),
                               HasSubstr("--masks"))));
    EXPECT_THAT(report->next,
                ElementsAre("some/bin/world_server",
                            AllOf(HasSubstr("some/bin/site_node"), HasSubstr("--recording")),
                            HasSubstr("some/bin/viewer")));
    const auto again = import(options_);
    ASSERT_FALSE(again);
    EXPECT_THAT(again.error().message, HasSubstr("--force"));
    options_.force = true;
    EXPECT_TRUE(import(options_));
    options_.output = folder_.path() / "Ann's take";
    EXPECT_THAT(import(options_)->next, Contains(HasSubstr("/Ann'\\''s take' --capture.loop")));
}

TEST_F(ImportedRecording, AssumesARateThatPicturesDoNotSay) {
    for (int camera = 1; camera <= 3; ++camera) {
        for (int i = 0; i < 3; ++i)
            write_picture(take(fmt::format("cam{}/{:04}.png", camera, i)), 64, 48, 40);
    }
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->checks,
                Contains(AllOf(HasSubstr("rate: 30 Hz is assumed"), HasSubstr("--rate"))));
    EXPECT_THAT(report->told, testing::Not(Contains(HasSubstr("rate:"))));
}

TEST_F(ImportedRecording, RefusesAnEmptyRoomOfAnotherSizeBeforeAnythingIsWritten) {
    for (int camera = 1; camera <= 3; ++camera) {
        write_video(take(fmt::format("cam{}.avi", camera)), 64, 48, 3);
        write_picture(take(fmt::format("background/cam{}.png", camera)),
                      camera == 2 ? 32 : 64,
                      camera == 2 ? 25 : 48,
                      10);
    }
    const auto report = import(options_);
    ASSERT_FALSE(report);
    EXPECT_THAT(report.error().message,
                AllOf(HasSubstr("the empty room of 'cam2' has another size"),
                      HasSubstr("background/cam2.png has 32x25 px, the pictures of 'cam2' 64x48")));
    EXPECT_FALSE(fs::exists(options_.output));
    write_picture(take("background/cam2.png"), 65, 49, 10);  // read without the odd row and column
    EXPECT_TRUE(import(options_));
}

TEST_F(ImportedRecording, SaysThatColmapDidNotRegisterACamera) {
    folder_.write("model/images.txt", test::colmap_images_txt(cameras_, 1.0));
    folder_.write("model/cameras.txt", test::colmap_cameras_txt(cameras_));
    options_.files = {folder_.path() / "model"};
    options_.said.distance = Said::Distance{
        "cam1", "cam2", (cameras_[0].centre_site() - cameras_[1].centre_site()).norm()};
    for (const char* camera : {"cam1", "cam2", "cam3", "door"})
        write_video(take(fmt::format("{}.avi", camera)), 64, 48, 3);
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->checks,
                Contains(AllOf(HasSubstr("pictures not used: 'door'"),
                               HasSubstr("COLMAP did not register them: solve again"))));
}

// A phone that walked about and helped COLMAP is no camera of the recording.
TEST_F(ImportedRecording, LeavesOutCamerasThatMovedAndHaveNoPictures) {
    std::string images = test::colmap_images_txt(cameras_, 1.0);
    std::string lenses = test::colmap_cameras_txt(cameras_);
    for (int i = 0; i < 120; ++i) {
        images +=
            fmt::format("{} 1 0 0 0 {} 0.5 2 1 phone/IMG_{:04}.jpg\n\n", 100 + i, 0.02 * i, 5 * i);
    }
    folder_.write("model/cameras.txt", lenses);
    folder_.write("model/images.txt", images);
    options_.files = {folder_.path() / "model"};
    options_.said.distance = Said::Distance{"cam1", "cam2", 2.0};
    for (int camera = 1; camera <= 3; ++camera)
        write_video(take(fmt::format("cam{}.avi", camera)), 64, 48, 8);
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->told,
                Contains(AllOf(HasSubstr("left out: 'phone': it moved, and has no pictures in"))));
    EXPECT_THAT(report->problems, testing::Not(Contains(HasSubstr("left out"))));
    fs::remove(take("cam3.avi"));
    options_.output = folder_.path() / "second";
    const auto fewer = import(options_);
    ASSERT_TRUE(fewer) << fewer.error().message;
    EXPECT_THAT(fewer->problems, Contains(HasSubstr("1 of 3 cameras left out")));
}

TEST_F(ImportedRecording, RefusesPicturesOfAnotherSizeUntilTold) {
    for (int camera = 1; camera <= 3; ++camera)
        write_video(take(fmt::format("cam{}.avi", camera)), 128, 96, 3);
    const auto report = import(options_);
    ASSERT_FALSE(report);
    EXPECT_THAT(report.error().message,
                AllOf(HasSubstr("64x48"),
                      HasSubstr("128x96"),
                      HasSubstr("--size 128x96"),
                      HasSubstr("if they were cropped, calibrate again with this crop")));
    options_.said.size = {128, 96};
    ASSERT_TRUE(import(options_));
    const auto rig = config::load_rig(options_.output);
    ASSERT_TRUE(rig);
    EXPECT_NEAR(rig->cameras[0].intrinsics.fx, 2.0 * cameras_[0].intrinsics.fx, 1e-9);
}

TEST_F(ImportedRecording, DoubtsASizeOfAnotherShape) {
    for (int camera = 1; camera <= 3; ++camera)
        write_video(take(fmt::format("cam{}.avi", camera)), 640, 476, 3);
    options_.said.calibrated_size = {640, 480};
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->problems,
                Contains(AllOf(HasSubstr("size: 'cam1', 'cam2', 'cam3': calibrated at 640x480 px"),
                               HasSubstr("these shapes differ by 0.83 %"),
                               HasSubstr("cropped rather than scaled?"))));
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
    options_.recording = folder_.path() / "cam2";
    for (int i = 0; i < 2; ++i) write_picture(take(fmt::format("{:04}.png", i)), 64, 48, 40);
    options_.output = folder_.path() / "made";
    EXPECT_THAT(import(options_).error().message,
                AllOf(HasSubstr("camera 'cam2' alone"), HasSubstr("give the one above it")));
}

TEST_F(ImportedRecording, LearnsTheRoomFromManyPicturesWithPeople) {
    for (int camera = 1; camera <= 3; ++camera)
        write_video(take(fmt::format("cam{}.avi", camera)), 64, 48, 8);
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->problems, IsEmpty());
    EXPECT_THAT(report->checks, Contains(HasSubstr("the site learns it from the pictures")));
}

TEST_F(ImportedRecording, NamesTruncatedPicturesAndTheCure) {
    for (int camera = 1; camera <= 3; ++camera) {
        for (int i = 0; i < 9; ++i)
            write_picture(take(fmt::format("cam{}/{:04}.png", camera, i)), 64, 48, 40);
    }
    const auto cut = [&](const std::string& name) {
        fs::resize_file(take(name), fs::file_size(take(name)) - 20);
    };
    cut("cam2/0004.png");
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->problems,
                Contains(AllOf(HasSubstr("camera 'cam2': 1 picture is truncated"),
                               HasSubstr("0004.png; copy"))));
    fs::resize_file(take("cam2/0006.png"), 0);
    options_.force = true;
    EXPECT_THAT(import(options_)->problems,
                Contains(HasSubstr("camera 'cam2': 2 pictures are truncated: ")));
    cut("cam3/0000.png");
    options_.output = folder_.path() / "second";
    const auto refused = import(options_);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message,
                AllOf(HasSubstr("0000.png: the file is truncated"), HasSubstr("copy it again")));
}

TEST_F(ImportedRecording, CountsTheWholePicturesOfATruncatedVideo) {
    for (int camera = 1; camera <= 3; ++camera)
        write_video(take(fmt::format("cam{}.avi", camera)), 64, 48, 20);
    fs::resize_file(take("cam2.avi"), fs::file_size(take("cam2.avi")) * 3 / 4);
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->told, Contains(HasSubstr("camera 'cam1': cam1, 20 pictures")));
    EXPECT_THAT(report->told, Not(Contains(HasSubstr("camera 'cam2': cam2, 20 pictures"))));
    EXPECT_THAT(
        report->problems,
        Contains(AllOf(HasSubstr("camera 'cam2': " + take("cam2.avi").string()),
                       HasSubstr("the video ends after picture "),
                       HasSubstr(" of 20: the file is truncated; copy or export it again"))));
}

TEST_F(ImportedRecording, NamesPicturesThatNoCameraHas) {
    for (int camera = 1; camera <= 4; ++camera)
        write_video(take(fmt::format("cam{}.avi", camera)), 64, 48, 8);
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->checks, Contains(HasSubstr("pictures not used: 'cam4'")));
}

TEST_F(ImportedRecording, RefusesPicturesWithoutACommonNumber) {
    for (int camera = 1; camera <= 3; ++camera) {
        for (int i = 0; i < 3; ++i)
            write_picture(
                take(fmt::format("cam{}/{:04}.png", camera, 100 * camera + i)), 64, 48, 40);
    }
    const auto report = import(options_);
    ASSERT_FALSE(report);
    EXPECT_THAT(report.error().message,
                AllOf(HasSubstr("no number in common"), HasSubstr("100 to 102 of 'cam1'")));
}

TEST_F(ImportedRecording, ReadsAFolderOfCalibrationFiles) {
    const fs::path folder = folder_.path() / "calibration";
    fs::create_directories(folder);
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
        std::ofstream(folder / fmt::format("cam{}.yml", i + 1))
            << test::opencv_yaml({cameras_[i]}, 1000.0);
    }
    std::ofstream(folder / "notes.md") << "not a calibration";
    options_.files = {folder};
    options_.recording.clear();
    options_.output = folder_.path() / "rig.toml";
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(config::load_rig(options_.output)->cameras.size(), 3U);
    // of another program
    std::ofstream(folder / "other.toml") << test::caliscope_toml(cameras_);
    options_.output = folder_.path() / "other_rig.toml";
    const auto mixed = import(options_);
    ASSERT_FALSE(mixed);
    EXPECT_THAT(
        mixed.error().message,
        AllOf(HasSubstr("cam1.yml and "), HasSubstr("other.toml are of different formats")));
    fs::create_directories(folder_.path() / "empty");
    options_.files = {folder_.path() / "empty"};
    const auto none = import(options_);
    ASSERT_FALSE(none);
    EXPECT_THAT(none.error().message, HasSubstr("give the calibration files"));
}

// A layer of 25 pictures per second, each of one tick, as DivX writes it.
TEST_F(ImportedRecording, FindsTheOnlyModelInAFolderOfColmap) {
    const fs::path model = folder_.path() / "colmap/sparse/0";
    fs::create_directories(model);
    const auto opened = [&](const char* name) {
        return with_folders_opened({folder_.path() / name});
    };
    EXPECT_FALSE(opened("colmap"));
    std::ofstream(model / "cameras.bin") << "";
    for (const char* name : {"colmap", "colmap/sparse", "colmap/sparse/0"}) {
        const auto found = opened(name);
        ASSERT_TRUE(found) << found.error().message;
        EXPECT_THAT(*found, ElementsAre(model));
    }
    fs::create_directories(folder_.path() / "colmap/sparse/1");
    std::ofstream(folder_.path() / "colmap/sparse/1/cameras.bin") << "";
    const auto several = opened("colmap");
    ASSERT_FALSE(several);
    EXPECT_THAT(several.error().message,
                AllOf(HasSubstr("this folder holds 2 models of COLMAP: "),
                      HasSubstr("sparse/0, "),
                      HasSubstr("sparse/1; give the one with all cameras")));
}

TEST(CodecRate, IsThatOfMpeg4PicturesInAviOnly) {
    const test::Folder folder;
    const auto avi = [&](const std::string& codec) {
        std::string text =
            "RIFF....AVI LIST....hdrlstrl"
            "strh....vids" +
            codec;
        text += std::string(40, '\0') + "movi00dc....";
        const unsigned char layer[] = {0, 0, 1, 0x20, 0x08, 0x84, 0x40, 0x06, 0x70, 0x80};
        text.append(reinterpret_cast<const char*>(layer), sizeof(layer));
        return folder.write(codec + ".avi", text);
    };
    EXPECT_DOUBLE_EQ(codec_rate_hz(avi("DX50")), 25.0);
    EXPECT_DOUBLE_EQ(codec_rate_hz(avi("MJPG")), 0.0);
    EXPECT_DOUBLE_EQ(codec_rate_hz(folder.write("cut.avi", "RIFF....AVI strh....vidsDIVXmovi")),
                     0.0);
    EXPECT_DOUBLE_EQ(codec_rate_hz(folder.path() / "none.avi"), 0.0);
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

// What the names of all pictures, or of all cameras, have in common does not hide a name in
// another.
TEST(Likeness, TellsNamesApartThatContainEachOther) {
    const std::vector<std::string> plain{"back", "front", "left_back"};
    const std::vector<std::string> named{"GoPro_back", "GoPro_front", "GoPro_left_back"};
    const std::vector<std::string> takes{
        "GoPro_back_take2", "GoPro_front_take2", "GoPro_left_back_take2"};
    for (const auto& cameras : {plain, named}) {
        std::vector<Shots> shots;
        for (const std::string& label : takes) {
            shots.push_back({label + ".mp4", true, {}, label});
        }
        const auto matches = match_shots(cameras, shots);
        ASSERT_TRUE(matches) << matches.error().message;
        for (std::size_t i = 0; i < cameras.size(); ++i)
            EXPECT_EQ(matches->by_camera.at(cameras[i]).label, takes[i]);
    }
    const std::vector<std::string> others{"back_0", "front_0", "left_back_0"};
    EXPECT_EQ(likeness("cam_back", "back_0", others, {"cam_back", "cam_front"}), 85);
}

}  // namespace
}  // namespace atrium::calibrate
