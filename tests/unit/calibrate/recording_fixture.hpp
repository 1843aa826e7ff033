#pragma once

#include "site_node/capture/recording_source.hpp"
#include "tests/unit/calibrate/foreign_texts.hpp"
#include "tools/calibrate/import.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include <filesystem>
#include <string>

/// Three cameras of 64x48 px, whose calibration is in mm; pictures are added by each test.
namespace atrium::calibrate::test {

inline void write_picture(const std::filesystem::path& file, int width, int height, int grey) {
    std::filesystem::create_directories(file.parent_path());
    ASSERT_TRUE(cv::imwrite(file.string(), cv::Mat(height, width, CV_8UC3, cv::Scalar::all(grey))));
}

inline void write_video(const std::filesystem::path& file,
                        int width,
                        int height,
                        int num_frames,
                        int codec = cv::VideoWriter::fourcc('M', 'J', 'P', 'G'),
                        double rate_hz = 25.0) {
    std::filesystem::create_directories(file.parent_path());
    cv::VideoWriter video(file.string(), codec, rate_hz, {width, height});
    ASSERT_TRUE(video.isOpened());
    for (int i = 0; i < num_frames; ++i)
        video.write(cv::Mat(height, width, CV_8UC3, cv::Scalar::all(20 + 20 * i)));
}

class ImportedRecording : public ::testing::Test {
protected:
    void SetUp() override {
        atrium::test::Random random(21);
        cameras_ = random_room(random, 3);
        for (auto& camera : cameras_) {
            camera.intrinsics.width = 64;
            camera.intrinsics.height = 48;
        }
        options_.files = {folder_.write("all.yml", opencv_yaml(cameras_, 1000.0))};
        options_.recording = folder_.path() / "take";
        options_.output = folder_.path() / "made";
    }
    std::filesystem::path take(const std::string& name) const { return options_.recording / name; }

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

    Folder folder_;
    Cameras cameras_;
    ImportOptions options_;
};

}  // namespace atrium::calibrate::test
