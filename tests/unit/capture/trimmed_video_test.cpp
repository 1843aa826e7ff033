#include "site_node/capture/video_length.hpp"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace atrium::capture {
namespace {

namespace fs = std::filesystem;

constexpr int kNumPictures = 60;
constexpr int kRateHz = 25;

class TrimmedVideo : public testing::Test {
protected:
    TrimmedVideo() {
        cv::VideoWriter writer(
            file_.string(), cv::VideoWriter::fourcc('m', 'p', '4', 'v'), kRateHz, cv::Size(64, 48));
        for (int i = 0; i < kNumPictures; ++i)
            writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(4 * i)));
    }
    ~TrimmedVideo() override { fs::remove(file_); }

    // As `ffmpeg -ss T -t T -i FILE -c copy` leaves it: the edit list names the time that is shown.
    void trim(int num_cut, int num_left) {
        std::ifstream in(file_, std::ios::binary);
        std::string bytes(std::istreambuf_iterator<char>(in), {});
        in.close();
        const auto number_at = [&](std::size_t at) {
            std::uint32_t value = 0;
            for (std::size_t i = 0; i < 4; ++i)
                value = value << 8U | static_cast<unsigned char>(bytes[at + i]);
            return value;
        };
        const auto put = [&](std::size_t at, std::uint32_t value) {
            for (std::size_t i = 0; i < 4; ++i)
                bytes[at + i] = static_cast<char>(value >> (24 - 8 * i));
        };
        // version 0: the unit follows the box's name, version and two times
        const std::size_t movie = bytes.find("mvhd"), media = bytes.find("mdhd");
        const std::size_t edits = bytes.find("elst");
        ASSERT_NE(edits, std::string::npos);
        ASSERT_EQ(number_at(edits + 8), 1U) << "one edit";
        put(edits + 12, number_at(movie + 16) * static_cast<std::uint32_t>(num_left) / kRateHz);
        put(edits + 16, number_at(media + 16) * static_cast<std::uint32_t>(num_cut) / kRateHz);
        std::ofstream(file_, std::ios::binary) << bytes;
    }
    std::size_t num_decoded() const {
        cv::VideoCapture video(file_.string(), cv::CAP_FFMPEG);
        std::size_t number = 0;
        while (video.grab()) ++number;
        return number;
    }
    std::size_t in_header() const {
        return static_cast<std::size_t>(
            cv::VideoCapture(file_.string(), cv::CAP_FFMPEG).get(cv::CAP_PROP_FRAME_COUNT));
    }

    const fs::path file_ =
        fs::temp_directory_path() / ("atrium-trimmed-" + std::to_string(getpid()) + ".mp4");
};

TEST_F(TrimmedVideo, HasThePicturesThatDecodersDeliver) {
    ASSERT_EQ(in_header(), std::size_t{kNumPictures});
    EXPECT_EQ(num_shown_pictures(file_, kNumPictures), std::size_t{kNumPictures}) << "not trimmed";
    // pictures depend on others before them: mostly the cut is between two that stand alone
    for (const int cut : {1, 7, 17, 24, 31}) {
        trim(cut, 20);
        EXPECT_EQ(in_header(), std::size_t{kNumPictures}) << "the header lies";
        EXPECT_EQ(num_decoded(), 20U) << cut;
        EXPECT_EQ(num_shown_pictures(file_, kNumPictures), num_decoded()) << cut;
    }
}

TEST_F(TrimmedVideo, IsBelievedWhereItSaysNothing) {
    EXPECT_EQ(num_shown_pictures(fs::temp_directory_path() / "none.mp4", 7), 7U);
    fs::resize_file(file_, fs::file_size(file_) / 2);
    EXPECT_EQ(num_shown_pictures(file_, 7), 7U) << "without its index";
    std::ofstream(file_) << "no video";
    EXPECT_EQ(num_shown_pictures(file_, 7), 7U);
}

}  // namespace
}  // namespace atrium::capture
