#include "site_node/capture/recording_source.hpp"

#include "site_node/capture/metaframe_assembler.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include <fstream>

namespace atrium::capture {
namespace {

namespace fs = std::filesystem;

std::uint8_t luma(const image::RawImage& picture, int x, int y) {
    image::YuvImage buffer;
    return image::working_view(picture, buffer).y.at(x, y);
}
using testing::Each;
using testing::HasSubstr;
using testing::IsTrue;

constexpr int kWidth = 64;
constexpr int kHeight = 48;

// A recording of two cameras. Frame k of a camera is grey with value 10 (k + 1) + camera.
class RecordingOnDisk : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::path(testing::TempDir()) /
                  (std::string("recording_") +
                   testing::UnitTest::GetInstance()->current_test_info()->name());
        fs::remove_all(folder_);
        fs::create_directories(folder_);
        std::ofstream rig(folder_ / "rig.toml");
        rig << "units = \"m\"\nrate_hz = 500\n";
        for (const char* name : {"a", "b"}) {
            rig << "[[camera]]\nname = \"" << name
                << "\"\nwidth = 64\nheight = 48\nfx = 60\nfy = 60\ncx = 31.5\n"
                << "cy = 23.5\nrotation = [1,0,0,0,1,0,0,0,1]\ntranslation = [0,0,3]\n";
            fs::create_directories(folder_ / name);
        }
    }
    void TearDown() override { fs::remove_all(folder_); }

    static cv::Mat grey(int value) {
        return cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar(value, value, value));
    }
    static std::string numbered(int index) { return cv::format("%06d.png", index); }

    void write_sequence(const std::string& camera,
                        int num_frames,
                        const std::string& stem = "frames") {
        fs::create_directories(folder_ / camera / stem);
        for (int k = 0; k < num_frames; ++k) {
            cv::imwrite((folder_ / camera / stem / numbered(k)).string(),
                        grey(10 * (k + 1) + (camera == "b")));
        }
    }

    void write_video(const std::string& camera,
                     int num_frames,
                     const std::string& name = "frames.avi") {
        cv::VideoWriter writer((folder_ / camera / name).string(),
                               cv::VideoWriter::fourcc('M', 'J', 'P', 'G'),
                               25,
                               cv::Size(kWidth, kHeight));
        for (int k = 0; k < num_frames; ++k) writer.write(grey(10 * (k + 1) + (camera == "b")));
    }

    std::vector<CameraFrame> play(RecordingOptions options,
                                  std::size_t stop_after = ~std::size_t{0}) {
        options.folder = folder_;
        auto source = RecordingSource::open(options);
        EXPECT_TRUE(source) << (source ? "" : source.error().message);
        std::vector<CameraFrame> frames;
        if (!source) return frames;
        std::stop_source stop;
        const auto result = (*source)->run(stop.get_token(), [&](CameraFrame frame) {
            frames.push_back(std::move(frame));
            if (frames.size() >= stop_after) stop.request_stop();
        });
        EXPECT_TRUE(result) << (result ? "" : result.error().message);
        return frames;
    }

    fs::path folder_;
};

TEST_F(RecordingOnDisk, PlaysInOrderWithOneTimePerTrigger) {
    write_sequence("a", 3);
    write_sequence("b", 3);
    const auto frames = play({});
    ASSERT_EQ(frames.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_EQ(frames[i].camera, i % 2);
        EXPECT_EQ(luma(frames[i].image, 5, 5), 10 * (i / 2 + 1) + i % 2);
        EXPECT_EQ(frames[i].capture_time, frames[i / 2 * 2].capture_time);
        EXPECT_EQ(frames[i].silhouette, nullptr);
    }
    EXPECT_LT(frames[0].capture_time, frames[2].capture_time);
}

TEST_F(RecordingOnDisk, PlaysVideos) {
    write_video("a", 4);
    write_video("b", 4);
    const auto frames = play({});
    ASSERT_EQ(frames.size(), 8u);
    for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_NEAR(
            luma(frames[i].image, 20, 20), static_cast<double>(10 * (i / 2 + 1) + i % 2), 3.0);
    }
}

TEST_F(RecordingOnDisk, LoopsOnlyOnRequest) {
    write_video("a", 2);
    write_sequence("b", 2);
    RecordingOptions loop;
    loop.loop = true;
    const auto frames = play(loop, 10);
    ASSERT_GE(frames.size(), 10u);
    EXPECT_NEAR(luma(frames[8].image, 5, 5), luma(frames[0].image, 5, 5), 1);
    EXPECT_LT(frames[0].capture_time, frames[8].capture_time);
}

TEST_F(RecordingOnDisk, MissingPictureLeavesItsMetaframeIncomplete) {
    write_sequence("a", 3);
    write_sequence("b", 3);
    fs::remove(folder_ / "b" / "frames" / numbered(1));
    std::ofstream(folder_ / "a" / "frames" / numbered(2)) << "not a picture";
    const auto frames = play({});
    EXPECT_EQ(frames.size(), 4u);
    MetaframeAssembler assembler(2, {std::chrono::microseconds(500), std::chrono::seconds(1)});
    std::size_t num_complete = 0;
    for (const auto& frame : frames) num_complete += assembler.add(frame, {}).has_value();
    EXPECT_EQ(num_complete, 1u);
}

TEST_F(RecordingOnDisk, CountsDeliveredAndUnreadablePictures) {
    write_sequence("a", 3);
    write_sequence("b", 3);
    std::ofstream(folder_ / "a" / "frames" / numbered(2)) << "not a picture";
    auto source = RecordingSource::open({folder_});
    ASSERT_TRUE(source);
    ASSERT_EQ((*source)->camera_counters().size(), 2u);
    EXPECT_FALSE((*source)->camera_counters()[0].last_picture);
    ASSERT_TRUE((*source)->run(std::stop_token(), [](CameraFrame) {}));
    const auto counters = (*source)->camera_counters();
    EXPECT_EQ(counters[0].name, "a");
    EXPECT_TRUE(counters[0].connected);
    EXPECT_EQ(counters[0].num_received, 2u);
    EXPECT_EQ(counters[0].num_incomplete, 1u);
    EXPECT_EQ(counters[1].num_received, 3u);
    EXPECT_EQ(counters[1].num_incomplete, 0u);
    ASSERT_TRUE(counters[0].last_picture);
    EXPECT_LE(*counters[0].last_picture, *counters[1].last_picture);
}

TEST_F(RecordingOnDisk, DeliversSilhouettesAsBinaryMasks) {
    for (const char* camera : {"a", "b"}) {
        write_sequence(camera, 1);
        fs::create_directories(folder_ / camera / "silhouettes");
        cv::Mat mask(kHeight, kWidth, CV_8UC1, cv::Scalar(0));
        mask.colRange(10, 20) = 200;
        mask.colRange(20, 30) = 100;
        cv::imwrite((folder_ / camera / "silhouettes" / numbered(0)).string(), mask);
    }
    const auto frames = play({});
    ASSERT_EQ(frames.size(), 2u);
    ASSERT_NE(frames[0].silhouette, nullptr);
    EXPECT_EQ(frames[0].silhouette->at(15, 5), 255);
    EXPECT_EQ(frames[0].silhouette->at(25, 5), 0);
}

TEST_F(RecordingOnDisk, KeepsTheRecordedTimesOfEachCamera) {
    write_sequence("a", 2);
    write_sequence("b", 2);
    std::ofstream(folder_ / "times.csv")
        << "frame, camera, capture_time_ns\n0, a, 1000\n0, b, 4000\n1, b, 2000000\n1, a, 2001500\n";
    const auto frames = play({});
    ASSERT_EQ(frames.size(), 4u);
    EXPECT_EQ((frames[1].capture_time - frames[0].capture_time).count(), 3000);
    EXPECT_EQ((frames[2].capture_time - frames[3].capture_time).count(), 1500);
}

TEST_F(RecordingOnDisk, KnowsTheRateAtWhichItWasRecorded) {
    write_sequence("a", 5);
    write_sequence("b", 5);
    EXPECT_EQ((*RecordingSource::open({.folder = folder_}))->recorded_hz(), 0.0);
    // 10 Hz, one instant missing; b is late
    std::ofstream(folder_ / "times.csv")
        << "0, a, 100000000\n0, b, 103000000\n1, b, 201000000\n1, a, 200000000\n"
           "2, a, 300000000\n3, a, 500000000\n4, a, 600000000\n";
    EXPECT_DOUBLE_EQ((*RecordingSource::open({.folder = folder_}))->recorded_hz(), 10.0);
}

TEST_F(RecordingOnDisk, NamesTheBadLineOfATimesFile) {
    write_sequence("a", 1);
    write_sequence("b", 1);
    for (const char* line : {"0, c, 5\n", "0, a\n", "x, a, 5\n", "0, a, soon\n", "-1, a, 5\n"}) {
        std::ofstream(folder_ / "times.csv") << "0, a, 1\n" << line;
        const auto source = RecordingSource::open({folder_});
        ASSERT_FALSE(source) << line;
        EXPECT_THAT(source.error().message, HasSubstr("times.csv:2"));
    }
}

TEST_F(RecordingOnDisk, ShowsTheBackgroundInEveryForm) {
    write_sequence("a", 1);
    write_sequence("b", 1);
    cv::imwrite((folder_ / "a" / "background.png").string(), grey(77));
    write_video("b", 5, "background.avi");
    auto source = RecordingSource::open({folder_});
    ASSERT_TRUE(source);
    std::vector<std::vector<int>> seen(2);
    std::size_t enough = 1000;
    const auto remember = [&](std::size_t camera, const image::YuvView& picture) {
        seen[camera].push_back(picture.y.at(3, 3));
        return seen[camera].size() < enough;
    };
    EXPECT_THAT((*source)->show_background({0, 1}, remember, {}), Each(IsTrue()));
    EXPECT_THAT(seen[0], testing::ElementsAre(77));
    EXPECT_EQ(seen[1].size(), 5u);

    seen.assign(2, {});
    enough = 3;
    EXPECT_THAT((*source)->show_background({1}, remember, {}), Each(IsTrue()));
    EXPECT_EQ(seen[0].size(), 0u);
    EXPECT_EQ(seen[1].size(), 3u);
}

TEST_F(RecordingOnDisk, StopEndsTheBackgroundWithAnError) {
    write_sequence("a", 1);
    write_sequence("b", 1);
    for (const char* camera : {"a", "b"}) write_video(camera, 5, "background.avi");
    auto source = RecordingSource::open({folder_});
    ASSERT_TRUE(source);
    std::stop_source stop;
    std::size_t num_seen = 0;
    const auto end_it = [&](std::size_t, const image::YuvView&) {
        if (++num_seen == 2) stop.request_stop();
        return true;
    };
    const auto shown = (*source)->show_background({0, 1}, end_it, stop.get_token());
    EXPECT_EQ(num_seen, 2u);
    ASSERT_EQ(shown.size(), 2u);
    for (const auto& result : shown) {
        ASSERT_FALSE(result);
        EXPECT_EQ(result.error().kind, ErrorKind::kUnavailable);
    }
}

TEST_F(RecordingOnDisk, NamesMissingParts) {
    const auto no_folder = RecordingSource::open({"/nonexistent/room"});
    ASSERT_FALSE(no_folder);
    EXPECT_EQ(no_folder.error().kind, ErrorKind::kNotFound);
    EXPECT_THAT(no_folder.error().message, HasSubstr("/nonexistent/room"));
    write_sequence("a", 1);
    const auto no_frames = RecordingSource::open({folder_});
    ASSERT_FALSE(no_frames);
    EXPECT_THAT(no_frames.error().message, HasSubstr("frames.avi"));
    write_sequence("b", 1);
    auto source = RecordingSource::open({folder_});
    ASSERT_TRUE(source);
    const auto no_background =
        (*source)->show_background({0}, [](std::size_t, const auto&) { return true; }, {})[0];
    ASSERT_FALSE(no_background);
    EXPECT_THAT(no_background.error().message, HasSubstr("background"));
    EXPECT_FALSE((*source)->read_frame(1));
    EXPECT_TRUE((*source)->read_frame(0));
}

TEST_F(RecordingOnDisk, ReadsAFrameWithoutTheCameraThatLacksIt) {
    write_sequence("a", 1);
    write_sequence("b", 2);
    auto source = RecordingSource::open({folder_});
    ASSERT_TRUE(source);
    EXPECT_FALSE((*source)->read_frame(1));
    const auto frame = (*source)->read_frame(1, {"a"});
    ASSERT_TRUE(frame) << frame.error().message;
    ASSERT_EQ(frame->frames.size(), 2u);
    EXPECT_TRUE(frame->frames[0].image.empty());
    EXPECT_EQ(frame->frames[1].camera, 1u);
    EXPECT_EQ(luma(frame->frames[1].image, 5, 5), 21);
}

TEST_F(RecordingOnDisk, RefusesPicturesThatDoNotMatchTheRigSize) {
    write_sequence("a", 2);
    write_sequence("b", 2);
    const cv::Mat small(20, 20, CV_8UC3, cv::Scalar(1, 2, 3));
    cv::imwrite((folder_ / "b" / "frames" / numbered(1)).string(), small);
    auto source = RecordingSource::open({folder_});
    ASSERT_TRUE(source) << source.error().message;
    EXPECT_TRUE((*source)->read_frame(0));
    const auto frame = (*source)->read_frame(1);
    ASSERT_FALSE(frame);
    EXPECT_THAT(frame.error().message, HasSubstr("frame 1 has 20x20 px, but rig.toml says 64x48"));
    // all pictures of a camera: at once
    cv::imwrite((folder_ / "b" / "frames" / numbered(0)).string(), small);
    source = RecordingSource::open({folder_});
    ASSERT_FALSE(source);
    EXPECT_THAT(source.error().message,
                HasSubstr("b/frames: the pictures have 20x20 px, but rig.toml says 64x48"));
}

TEST_F(RecordingOnDisk, NamesEachPictureThatItLeavesOut) {
    write_sequence("a", 3);
    write_sequence("b", 3);
    const fs::path frames = folder_ / "b" / "frames";
    fs::resize_file(frames / numbered(1), 60);
    fs::resize_file(frames / numbered(2), 0);
    RecordingOptions options{folder_};
    std::vector<std::string> reasons;
    options.report_unreadable = [&](const std::string& reason) { reasons.push_back(reason); };
    auto source = RecordingSource::open(options);
    ASSERT_TRUE(source);
    EXPECT_TRUE((*source)->run(std::stop_token(), [](CameraFrame) {}));
    ASSERT_EQ(reasons.size(), 2u);
    EXPECT_THAT(reasons[0], HasSubstr("camera 'b': " + (frames / numbered(1)).string()));
    EXPECT_THAT(reasons[0], HasSubstr("the file is truncated"));
    EXPECT_THAT(reasons[1], HasSubstr("the file is empty"));
}

TEST_F(RecordingOnDisk, NamesATruncatedVideoOnceAndPlaysItsWholePictures) {
    constexpr std::size_t kPictures = 20;
    write_video("a", kPictures);
    write_video("b", kPictures);
    const fs::path video = folder_ / "b" / "frames.avi";
    fs::resize_file(video, fs::file_size(video) * 3 / 4);
    std::vector<std::string> reasons;
    RecordingOptions options{folder_};
    options.report_unreadable = [&](const std::string& reason) { reasons.push_back(reason); };
    const auto frames = play(options);
    ASSERT_EQ(reasons.size(), 1u);
    EXPECT_THAT(reasons[0],
                HasSubstr("camera 'b': " + video.string() + ": the video ends after picture "));
    EXPECT_THAT(reasons[0], HasSubstr(" of 20: the file is truncated; copy or export it again"));
    std::size_t num_whole = 0;
    for (const CameraFrame& frame : frames) {
        if (frame.camera == 0) continue;
        EXPECT_NEAR(luma(frame.image, 20, 20), static_cast<double>(10 * ++num_whole + 1), 3.0);
    }
    EXPECT_THAT(num_whole, testing::AllOf(testing::Gt(3u), testing::Lt(20u)));
    EXPECT_THAT(reasons[0], HasSubstr("picture " + std::to_string(num_whole) + " of 20"));
    EXPECT_EQ(frames.size(), kPictures + num_whole);
}

TEST_F(RecordingOnDisk, IsAsLongAsItsLongestVideoReallyIs) {
    for (const char* camera : {"a", "b"}) {
        write_video(camera, 20);
        const fs::path video = folder_ / camera / "frames.avi";
        fs::resize_file(video, fs::file_size(video) * 3 / 4);
    }
    const auto source = RecordingSource::open({folder_});
    ASSERT_TRUE(source) << source.error().message;
    EXPECT_LT((*source)->num_frames(), 20u);
    EXPECT_TRUE((*source)->read_frame((*source)->num_frames() - 1));
}

TEST_F(RecordingOnDisk, NamesAVideoThatIsDamagedInside) {
    write_video("a", 20);
    write_video("b", 20);
    const fs::path video = folder_ / "b" / "frames.avi";
    {
        std::fstream stream(video, std::ios::binary | std::ios::in | std::ios::out);
        stream.seekp(static_cast<std::streamoff>(fs::file_size(video) / 2));
        stream << std::string(2000, '\0');
    }
    std::vector<std::string> reasons;
    RecordingOptions options{folder_};
    options.report_unreadable = [&](const std::string& reason) { reasons.push_back(reason); };
    play(options);
    ASSERT_FALSE(reasons.empty());
    EXPECT_THAT(reasons, testing::Each(reasons.front()));
    EXPECT_THAT(reasons[0],
                testing::AllOf(HasSubstr(video.string() + ": the video is damaged: "),
                               HasSubstr(" of its 20 pictures cannot be decoded"),
                               HasSubstr("copy or export it again")));
}

TEST_F(RecordingOnDisk, FailsIfNoPictureCanBeRead) {
    for (const char* camera : {"a", "b"}) {
        fs::create_directories(folder_ / camera / "frames");
        std::ofstream(folder_ / camera / "frames" / numbered(0)) << "garbage";
    }
    RecordingOptions loop{folder_, 0.0, true};
    auto source = RecordingSource::open(loop);
    ASSERT_TRUE(source);
    EXPECT_FALSE((*source)->run(std::stop_token(), [](CameraFrame) {}));
}

}  // namespace
}  // namespace atrium::capture
