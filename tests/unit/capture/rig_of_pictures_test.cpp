// Recordings that nobody has calibrated yet.
#include "site_node/capture/recording_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include <filesystem>
#include <fstream>
#include <string>

namespace atrium::capture {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr int kWide = 64, kTall = 48, kFrames = 3;

class UncalibratedRecording : public testing::Test {
protected:
    void SetUp() override {
        fs::remove_all(folder_);
        for (const char* camera : {"a", "b"}) {
            const fs::path frames = folder_ / camera / "frames";
            fs::create_directories(frames);
            for (int k = 0; k < kFrames; ++k)
                cv::imwrite((frames / cv::format("%06d.png", k)).string(),
                            cv::Mat(kTall, kWide, CV_8UC3, cv::Scalar(k, k, k)));
        }
    }
    void TearDown() override { fs::remove_all(folder_); }

    auto open() const { return RecordingSource::open({.folder = folder_, .needs_rig = false}); }
    std::string error() const {
        const auto opened = open();
        return opened ? std::string() : opened.error().message;
    }

    fs::path folder_ = fs::path(testing::TempDir()) / "uncalibrated_recording";
};

TEST_F(UncalibratedRecording, NeedsNoRigIfOnlyNamesAndSizesMatter) {
    fs::create_directories(folder_ / "notes");
    EXPECT_FALSE(RecordingSource::open({.folder = folder_}));
    const auto source = open();
    ASSERT_TRUE(source) << source.error().message;
    const config::Rig& rig = (*source)->rig();
    ASSERT_EQ(rig.cameras.size(), 2U);
    EXPECT_EQ(rig.cameras[0].name, "a");
    EXPECT_EQ(rig.cameras[1].name, "b");
    EXPECT_EQ(rig.cameras[1].intrinsics.width, kWide);
    EXPECT_EQ(rig.cameras[1].intrinsics.height, kTall);
    EXPECT_EQ((*source)->num_frames(), std::size_t{kFrames});
}

TEST_F(UncalibratedRecording, NamesWhatItCannotUse) {
    fs::rename(folder_ / "b", folder_ / "b c");
    EXPECT_THAT(error(), HasSubstr("b c: the name of a camera has 1 to 63 characters"));
    fs::remove_all(folder_ / "b c");
    EXPECT_THAT(error(), HasSubstr("1 folders hold pictures of a camera"));
    fs::create_directories(folder_ / "b" / "frames");
    std::ofstream(folder_ / "b" / "frames" / "000000.png") << "no picture";
    EXPECT_THAT(error(), HasSubstr("the first picture cannot be read"));
}

}  // namespace
}  // namespace atrium::capture
