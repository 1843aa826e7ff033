#include "viewer/record/picture_file.hpp"

#include "viewer/record/video_file.hpp"
#include "viewer/record/video_recorder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace atrium::viewer {
namespace {

class FilesTest : public testing::Test {
protected:
    const std::filesystem::path folder_ =
        std::filesystem::temp_directory_path() / ("atrium_viewer_test_" + std::to_string(getpid()));
    void SetUp() override { std::filesystem::create_directories(folder_); }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    static renderer::RenderedPicture picture(std::uint8_t red, std::uint8_t blue) {
        renderer::RenderedPicture p{.width = 64, .height = 48, .rgba = {}};
        for (int i = 0; i < 64 * 48; ++i)
            for (const int v : {static_cast<int>(red), i / 64, static_cast<int>(blue), 255})
                p.rgba.push_back(static_cast<std::uint8_t>(v));
        return p;
    }
};

TEST_F(FilesTest, PngHasThePictureUpright) {
    const auto file = folder_ / "new" / "p.png";
    const auto written = write_png(file, picture(200, 20));
    ASSERT_TRUE(written) << written.error().message;
    const cv::Mat read = cv::imread(file.string());
    ASSERT_EQ(read.size(), cv::Size(64, 48));
    EXPECT_EQ(read.at<cv::Vec3b>(47, 3), cv::Vec3b(20, 47, 200));
    EXPECT_EQ(read.at<cv::Vec3b>(0, 3), cv::Vec3b(20, 0, 200));
}

TEST_F(FilesTest, ReportsAFolderThatCannotBeCreated) {
    const auto written = write_png("/proc/none/p.png", picture(0, 0));
    ASSERT_FALSE(written);
    EXPECT_THAT(written.error().message, testing::HasSubstr("/proc/none/p.png"));
}

using Clock = VideoRecorder::Clock;

std::vector<int> reds_of(const std::filesystem::path& file) {
    cv::VideoCapture video(file.string());
    cv::Mat frame;
    std::vector<int> reds;
    while (video.read(frame)) reds.push_back(frame.at<cv::Vec3b>(24, 32)[2]);
    return reds;
}

TEST_F(FilesTest, VideoHasTheShownPictures) {
    const auto file = folder_ / "v.avi";
    {
        auto recorder =
            VideoRecorder::create({.file = file, .fps = 50.0, .width = 64, .height = 48});
        ASSERT_TRUE(recorder) << recorder.error().message;
        const auto now = Clock::now();
        EXPECT_TRUE((*recorder)->wants_picture(now));
        (*recorder)->offer(picture(220, 30), now);
        EXPECT_FALSE((*recorder)->wants_picture(now)) << "one picture per slot";
        while ((*recorder)->num_written() < 3) std::this_thread::yield();
        EXPECT_EQ((*recorder)->num_dropped(), 0U);
    }
    cv::VideoCapture video(file.string());
    cv::Mat frame;
    int count = 0;
    while (video.read(frame)) ++count;
    EXPECT_GE(count, 3);
    cv::VideoCapture again(file.string());
    ASSERT_TRUE(again.read(frame));
    EXPECT_NEAR(frame.at<cv::Vec3b>(24, 32)[2], 220, 6);
    EXPECT_NEAR(frame.at<cv::Vec3b>(24, 32)[0], 30, 6);
}

TEST_F(FilesTest, EveryVideoFormatHasItsPicturesAtTheirRate) {
    for (const char* name : {"v.avi", "v.mkv", "v.mp4"}) {
        SCOPED_TRACE(name);
        const auto file = folder_ / name;
        std::vector<int> expected;
        const auto video = create_video_file({file, 25.0, 64, 48});
        ASSERT_TRUE(video) << video.error().message;
        for (int red = 10; red < 250; red += 10) {
            ASSERT_TRUE((*video)->set(picture(static_cast<std::uint8_t>(red), 0).rgba));
            ASSERT_TRUE((*video)->write());
            ASSERT_TRUE((*video)->write());  // repeats the picture
            expected.insert(expected.end(), 2, red);
        }
        ASSERT_TRUE((*video)->finish());
        const std::vector<int> reds = reds_of(file);
        ASSERT_EQ(reds.size(), expected.size());
        for (std::size_t i = 0; i < reds.size(); ++i) EXPECT_NEAR(reds[i], expected[i], 8) << i;
        const cv::VideoCapture read(file.string(), cv::CAP_FFMPEG);
        EXPECT_NEAR(read.get(cv::CAP_PROP_FPS), 25.0, 1e-3);
    }
}

TEST_F(FilesTest, UnwritableVideoNamesItsFileAndTheReason) {
    const auto video = create_video_file({folder_ / "none" / "a.avi", 10.0, 64, 48});
    ASSERT_FALSE(video);
    EXPECT_EQ(video.error().kind, ErrorKind::kUnavailable);
    EXPECT_NE(video.error().message.find("a.avi"), std::string::npos) << video.error().message;
    EXPECT_NE(video.error().message.find("No such file"), std::string::npos)
        << video.error().message;
}

// Independent of a slow encoder: the times lie in the past, as if the drawing thread ran ahead.
TEST_F(FilesTest, VideoKeepsSlotsAndRepeatsPicturesInGaps) {
    const auto file = folder_ / "v.avi";
    auto recorder = VideoRecorder::create({.file = file, .fps = 0.5, .width = 64, .height = 48});
    ASSERT_TRUE(recorder) << recorder.error().message;
    const auto begin = Clock::now();
    // slots of 2 s, which no real time ends: 0, 1, 4, 5
    for (const auto& [slot, red] : {std::pair(0, 40), {1, 80}, {4, 160}, {5, 200}}) {
        const auto now = begin + std::chrono::seconds(2 * slot) + std::chrono::milliseconds(300);
        while (!(*recorder)->wants_picture(slot == 0 ? begin : now)) std::this_thread::yield();
        (*recorder)->offer(picture(static_cast<std::uint8_t>(red), 0), slot == 0 ? begin : now);
        EXPECT_FALSE((*recorder)->wants_picture(now + std::chrono::milliseconds(1000)))
            << "a slot takes only one picture";
    }
    ASSERT_TRUE((*recorder)->finish());
    const std::vector<int> expected{40, 80, 80, 80, 160, 200};
    const std::vector<int> reds = reds_of(file);
    ASSERT_EQ(reds.size(), expected.size());
    for (std::size_t i = 0; i < reds.size(); ++i) EXPECT_NEAR(reds[i], expected[i], 8) << i;
}

TEST_F(FilesTest, CountsAndRepeatsPicturesThatASlowEncoderMisses) {
    const auto file = folder_ / "v.avi";
    constexpr int kWidth = 1920;
    constexpr int kHeight = 1080;
    auto recorder =
        VideoRecorder::create({.file = file, .fps = 0.1, .width = kWidth, .height = kHeight});
    ASSERT_TRUE(recorder) << recorder.error().message;
    // More large pictures than the queue holds, in slots of 10 s, which no real time ends. Without
    // pauses they fill the queue on any machine sooner or later.
    const auto large = [](std::uint64_t slot) {
        renderer::RenderedPicture picture{kWidth, kHeight, {}};
        picture.rgba.assign(std::size_t{4} * kWidth * kHeight,
                            static_cast<std::uint8_t>(20 * slot));
        return picture;
    };
    std::vector<renderer::RenderedPicture> ready;
    for (std::uint64_t slot = 0; slot < 2 * VideoRecorder::kMostWaiting; ++slot)
        ready.push_back(large(slot));
    const auto begin = Clock::now();
    std::uint64_t num_slots = 0;
    std::uint64_t num_offered = 0;
    // until the queue takes a picture after it refused others
    for (bool has_dropped = false, is_over = false; !is_over; ++num_slots) {
        const auto now = begin + std::chrono::seconds(10 * num_slots);
        const std::uint64_t num_written = (*recorder)->num_written();
        if (!(*recorder)->wants_picture(now)) {
            has_dropped = true;
            while ((*recorder)->num_written() == num_written) std::this_thread::yield();
            continue;
        }
        if (ready.empty()) ready.push_back(large(num_slots));
        (*recorder)->offer(std::move(ready.back()), now);
        ready.pop_back();
        ++num_offered;
        is_over = has_dropped;
    }
    EXPECT_GT(num_offered, VideoRecorder::kMostWaiting);
    EXPECT_GT((*recorder)->num_dropped(), 0U);
    EXPECT_EQ(num_offered + (*recorder)->num_dropped(), num_slots);
    ASSERT_TRUE((*recorder)->finish());
    EXPECT_EQ((*recorder)->num_written(), num_slots);
    EXPECT_EQ(reds_of(file).size(), num_slots);
}

TEST_F(FilesTest, InterruptedVideoIsAnError) {
    const auto file = folder_ / "v.mp4";
    auto recorder = VideoRecorder::create({.file = file, .fps = 50.0, .width = 64, .height = 48});
    ASSERT_TRUE(recorder) << recorder.error().message;
    (*recorder)->offer(picture(220, 30), Clock::now());
    while ((*recorder)->num_written() < 3) std::this_thread::yield();
    std::filesystem::remove(file);
    const auto finished = (*recorder)->finish();
    ASSERT_FALSE(finished);
    EXPECT_THAT(finished.error().message, testing::HasSubstr("v.mp4"));
}

TEST_F(FilesTest, UnwritableVideoIsAnError) {
    const auto made =
        VideoRecorder::create({.file = "/proc/none/v.avi", .fps = 10.0, .width = 64, .height = 48});
    ASSERT_FALSE(made);
    EXPECT_THAT(made.error().message, testing::HasSubstr("/proc/none/v.avi"));
}

TEST_F(FilesTest, PreparationLeavesNoFilesAndKeepsExistingOnes) {
    const auto file = folder_ / "deep" / "er" / "p.png";
    ASSERT_TRUE(prepare_file(file));
    EXPECT_FALSE(std::filesystem::exists(file));
    EXPECT_TRUE(std::filesystem::is_directory(file.parent_path()));
    std::ofstream(file) << "before";
    ASSERT_TRUE(prepare_file(file));
    EXPECT_EQ(std::filesystem::file_size(file), 6u);
    EXPECT_FALSE(prepare_file(file.parent_path())) << "a folder";
}

}  // namespace
}  // namespace atrium::viewer
