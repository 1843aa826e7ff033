#include "site_node/capture/lost_pictures.hpp"

#include "site_node/capture/picture_file.hpp"
#include "tests/support/random.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/videoio.hpp>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <set>

namespace atrium::capture {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kPicturesOfVideo = 20;

std::uint32_t number_at(const std::string& bytes, std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

void put_number(std::string& bytes, std::size_t at, std::uint32_t value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
}

// Takes the bytes of pictures out, as programs that record write a lost picture: a chunk of size 0,
// here with unused bytes behind it. The index of the file says the same.
void lose_pictures(const fs::path& file, const std::set<std::size_t>& lost) {
    std::ifstream in(file, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(in), {}};
    in.close();
    const std::size_t movi = bytes.find("movi");
    const std::size_t end = movi + number_at(bytes, movi - 4);
    std::size_t num = 0;
    for (std::size_t at = movi + 4; at + 8 <= end;) {
        const std::uint32_t size = number_at(bytes, at + 4);
        const std::uint32_t padded = size + size % 2;
        const bool is_picture = bytes.compare(at + 2, 2, "dc") == 0;
        if (is_picture && lost.contains(num++)) {
            put_number(bytes, at + 4, 0);
            bytes.replace(at + 8, 4, "JUNK");
            put_number(bytes, at + 12, padded - 8);
        }
        at += 8 + padded;
    }
    const std::size_t index = bytes.find("idx1", end);
    std::size_t entry = 0;
    for (std::size_t at = index + 8; index != std::string::npos && at + 16 <= bytes.size();
         at += 16)
        if (bytes.compare(at + 2, 2, "dc") == 0 && lost.contains(entry++))
            put_number(bytes, at + 12, 0);
    std::ofstream(file, std::ios::binary) << bytes;
}

class LostPicturesTest : public testing::Test {
protected:
    void SetUp() override { fs::create_directories(folder_); }
    void TearDown() override { fs::remove_all(folder_); }

    // Picture k has a luma of about 10 (k + 1).
    void write_video() {
        cv::VideoWriter writer(
            file_.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25, cv::Size(64, 48));
        for (int k = 0; k < kPicturesOfVideo; ++k)
            writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(10.0 * (k + 1))));
    }

    fs::path folder_ = fs::temp_directory_path() / ("atrium-lost-" + std::to_string(getpid()));
    fs::path file_ = folder_ / "frames.avi";
};

TEST_F(LostPicturesTest, AreNumbersWithoutAPictureAndMoveNoOtherOne) {
    test::Random random(4);
    for (int round = 0; round < 20; ++round) {
        write_video();
        std::set<std::size_t> lost;
        // the first one is there: nothing can be shown once more before it
        for (int i = test::between(random, 0, 6); i > 0; --i)
            lost.insert(static_cast<std::size_t>(test::between(random, 1, kPicturesOfVideo - 1)));
        lose_pictures(file_, lost);
        const LostPictures found = lost_pictures(file_);
        EXPECT_EQ(std::set(found.numbers.begin(), found.numbers.end()), lost);

        auto pictures = PictureFile::find(folder_, "frames");
        ASSERT_TRUE(pictures) << pictures.error().message;
        std::size_t last = kPicturesOfVideo;
        while (lost.contains(last - 1)) --last;
        EXPECT_EQ(pictures->num_pictures(), last);
        EXPECT_EQ(pictures->what_is_missing().empty(), lost.empty());
        image::YuvImage picture;
        for (std::size_t k = 0; k < last; ++k) {
            const auto read = pictures->read(k, picture);
            EXPECT_EQ(pictures->has_lost(k), lost.contains(k));
            if (lost.contains(k)) {
                ASSERT_FALSE(read);
                EXPECT_EQ(read.error().kind, ErrorKind::kNotFound);
                continue;
            }
            ASSERT_TRUE(read) << read.error().message;
            EXPECT_NEAR(picture.y.at(20, 20), 10.0 * static_cast<double>(k + 1), 3.0);
        }
    }
}

TEST_F(LostPicturesTest, AreNamed) {
    write_video();
    EXPECT_THAT(lost_pictures(file_).numbers, IsEmpty());
    EXPECT_EQ(text_of_lost_pictures(lost_pictures(file_)), "");
    lose_pictures(file_, {3, 4, 5, 9});
    EXPECT_THAT(lost_pictures(file_).numbers, ElementsAre(3, 4, 5, 9));
    EXPECT_THAT(text_of_lost_pictures(lost_pictures(file_)),
                HasSubstr("the camera lost 4 of 20 pictures (3 to 5, 9)"));
    write_video();
    lose_pictures(file_, {1, 3, 5, 7, 9, 11});
    EXPECT_THAT(text_of_lost_pictures(lost_pictures(file_)), HasSubstr("(1, 3, 5, 7, ...)"));
}

TEST_F(LostPicturesTest, OfHostileBytesEndAndAreBounded) {
    write_video();
    std::ifstream in(file_, std::ios::binary);
    const std::string good{std::istreambuf_iterator<char>(in), {}};
    test::Random random(9);
    for (int round = 0; round < 300; ++round) {
        std::string bytes = good.substr(
            0, static_cast<std::size_t>(test::between(random, 0, static_cast<int>(good.size()))));
        for (int i = 0; i < 30 && !bytes.empty(); ++i) {
            const auto at = static_cast<std::size_t>(
                test::between(random, 0, static_cast<int>(bytes.size()) - 1));
            bytes[at] = static_cast<char>(test::between(random, 0, 255));
        }
        std::ofstream(file_, std::ios::binary) << bytes;
        const LostPictures lost = lost_pictures(file_);
        EXPECT_LE(lost.numbers.size(), lost.num_pictures);
        EXPECT_LE(lost.num_pictures, bytes.size() / 8);
    }
    EXPECT_EQ(lost_pictures(folder_ / "none.avi").num_pictures, 0U);
    EXPECT_EQ(lost_pictures(folder_).num_pictures, 0U);
}

}  // namespace
}  // namespace atrium::capture
