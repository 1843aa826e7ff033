#include "viewer/picture_file.hpp"

#include "viewer/newest_per_site.hpp"
#include "viewer/viewer_config.hpp"

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

TEST_F(FilesTest, PngHoldsThePictureInOrder) {
    const auto file = folder_ / "new" / "p.png";
    const auto written = write_png(file, picture(200, 20));
    ASSERT_TRUE(written) << written.error().message;
    const cv::Mat read = cv::imread(file.string());
    ASSERT_EQ(read.size(), cv::Size(64, 48));
    EXPECT_EQ(read.at<cv::Vec3b>(47, 3), cv::Vec3b(20, 47, 200));
    EXPECT_EQ(read.at<cv::Vec3b>(0, 3), cv::Vec3b(20, 0, 200));
}

TEST_F(FilesTest, AFolderThatCannotBeMadeIsAnError) {
    const auto written = write_png("/proc/none/p.png", picture(0, 0));
    ASSERT_FALSE(written);
    EXPECT_THAT(written.error().message, testing::HasSubstr("/proc/none/p.png"));
}

TEST_F(FilesTest, VideoHoldsWhatWasShown) {
    const auto file = folder_ / "v.avi";
    {
        auto recorder =
            VideoRecorder::create({.file = file, .fps = 50.0, .width = 64, .height = 48});
        ASSERT_TRUE(recorder) << recorder.error().message;
        EXPECT_TRUE((*recorder)->wants_picture());
        (*recorder)->offer(picture(220, 30));
        while ((*recorder)->num_written() < 3) std::this_thread::yield();
        EXPECT_TRUE((*recorder)->wants_picture());
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

TEST_F(FilesTest, AVideoThatIsCutOffBeforeItEndsIsAnError) {
    const auto file = folder_ / "v.mp4";
    auto recorder = VideoRecorder::create({.file = file, .fps = 50.0, .width = 64, .height = 48});
    ASSERT_TRUE(recorder) << recorder.error().message;
    (*recorder)->offer(picture(220, 30));
    while ((*recorder)->num_written() < 3) std::this_thread::yield();
    std::filesystem::remove(file);
    const auto finished = (*recorder)->finish();
    ASSERT_FALSE(finished);
    EXPECT_THAT(finished.error().message, testing::HasSubstr("v.mp4"));
}

TEST(VideoSize, KeepsTheShapeOfThePictureWhereOneSideIsGiven) {
    const auto size = [](int width, int height, std::pair<int, int> picture) {
        VideoConfig video;
        video.width = width;
        video.height = height;
        return video_size(video, picture);
    };
    EXPECT_EQ(size(0, 0, {960, 540}), std::pair(960, 540));
    EXPECT_EQ(size(320, 0, {960, 540}), std::pair(320, 180));
    EXPECT_EQ(size(0, 270, {960, 540}), std::pair(480, 270));
    EXPECT_EQ(size(100, 300, {960, 540}), std::pair(100, 300));
    EXPECT_EQ(size(333, 0, {961, 541}), std::pair(332, 186)) << "even";
    EXPECT_EQ(size(0, 1, {10, 1000}), std::pair(2, 2));
}

TEST_F(FilesTest, AVideoThatCannotBeWrittenIsAnError) {
    const auto made =
        VideoRecorder::create({.file = "/proc/none/v.avi", .fps = 10.0, .width = 64, .height = 48});
    ASSERT_FALSE(made);
    EXPECT_THAT(made.error().message, testing::HasSubstr("/proc/none/v.avi"));
}

TEST_F(FilesTest, PreparingLeavesNothingBehindAndWhatIsThereAlone) {
    const auto file = folder_ / "deep" / "er" / "p.png";
    ASSERT_TRUE(prepare_file(file));
    EXPECT_FALSE(std::filesystem::exists(file));
    EXPECT_TRUE(std::filesystem::is_directory(file.parent_path()));
    std::ofstream(file) << "before";
    ASSERT_TRUE(prepare_file(file));
    EXPECT_EQ(std::filesystem::file_size(file), 6u);
    EXPECT_FALSE(prepare_file(file.parent_path())) << "a folder";
}

TEST(NewestPerSite, ReplacesPerSiteAndServesSitesInTurn) {
    NewestPerSite<int> sut;
    EXPECT_FALSE(sut.put("a", 1));
    EXPECT_FALSE(sut.put("b", 10));
    EXPECT_EQ(sut.put("a", 2), 1);
    EXPECT_EQ(sut.take({})->value, 2);
    sut.put("a", 3);
    const auto next = sut.take({});  // b waits longer
    EXPECT_EQ(next->site, "b");
    EXPECT_EQ(next->value, 10);
    EXPECT_EQ(sut.take_all().size(), 1u);
    EXPECT_TRUE(sut.take_all().empty());
}

// A decoder that does not keep up always finds something.
TEST(NewestPerSite, AStopIsSeenWhileThereAreValues) {
    NewestPerSite<int> slots;
    slots.put("a", 1);
    std::stop_source source;
    source.request_stop();
    EXPECT_FALSE(slots.take(source.get_token()));
}

TEST(NewestPerSite, AStopEndsTheWait) {
    NewestPerSite<int> sut;
    std::stop_source source;
    std::jthread stopper([&] { source.request_stop(); });
    EXPECT_FALSE(sut.take(source.get_token()));
}

}  // namespace
}  // namespace atrium::viewer
