#include "site_node/capture/picture_file.hpp"
#include "site_node/capture/recording_source.hpp"
#include "site_node/capture/truncated_picture.hpp"
#include "site_node/capture/video_length.hpp"
#include "tests/support/pictures/rotation_tag.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include <algorithm>
#include <fstream>

namespace atrium::capture {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr int kMaskWidth = 64;
constexpr int kMaskHeight = 48;

// Masks and plates from elsewhere: two cameras, one instant.
class MasksOnDisk : public testing::Test {
protected:
    void SetUp() override {
        folder_ =
            fs::path(testing::TempDir()) /
            (std::string("masks_") + testing::UnitTest::GetInstance()->current_test_info()->name());
        fs::remove_all(folder_);
        fs::create_directories(folder_);
        std::ofstream rig(folder_ / "rig.toml");
        rig << "units = \"m\"\nrate_hz = 500\n";
        for (const char* name : {"a", "b"}) {
            rig << "[[camera]]\nname = \"" << name
                << "\"\nwidth = 64\nheight = 48\nfx = 60\nfy = 60\ncx = 31.5\n"
                << "cy = 23.5\nrotation = [1,0,0,0,1,0,0,0,1]\ntranslation = [0,0,3]\n";
            for (int k = 0; k < 7; ++k)
                write(fs::path(name) / "frames" / cv::format("%06d.png", k),
                      cv::Mat(kMaskHeight, kMaskWidth, CV_8UC3, cv::Scalar(90, 80, 10 * k)));
        }
    }
    void TearDown() override { fs::remove_all(folder_); }

    void write(const fs::path& file, const cv::Mat& picture) {
        fs::create_directories((folder_ / file).parent_path());
        ASSERT_TRUE(cv::imwrite((folder_ / file).string(), picture));
    }

    // A mask of `type`, with `on` in the left half and `off` in the right one.
    static cv::Mat half(int type, const cv::Scalar& on, const cv::Scalar& off) {
        cv::Mat picture(kMaskHeight, kMaskWidth, type, off);
        picture(cv::Rect(0, 0, kMaskWidth / 2, kMaskHeight)) = on;
        return picture;
    }

    fs::path folder_;
};

TEST_F(MasksOnDisk, ReadsMasksOfEveryKind) {
    const std::vector<cv::Mat> kinds{
        half(CV_8UC1, 255, 0),
        half(CV_8UC1, 1, 0),
        half(CV_8UC1, 128, 127),
        half(CV_8UC1, 24, 0),  // numbers of people or kinds
        half(CV_16UC1, 3, 0),
        half(CV_8UC3, {0, 0, 128}, {0, 0, 0}),  // a palette
        half(CV_8UC4, {0, 0, 128, 255}, {0, 0, 0, 255}),
        half(CV_16UC1, 65535, 0),
        half(CV_16UC1, 255, 0),
        half(CV_16UC1, 1, 0),
        half(CV_8UC3, {255, 255, 255}, {0, 0, 0}),
        half(CV_8UC4, {10, 20, 30, 255}, {200, 200, 200, 0}),  // a cut-out
        half(CV_8UC4, {255, 255, 255, 255}, {0, 0, 0, 255}),   // opaque: the colour counts
        half(CV_16UC4, {9, 9, 9, 65535}, {50000, 50000, 50000, 0})};
    for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
        write("masks/000000.png", kinds[kind]);
        auto file = PictureFile::find(folder_, "masks");
        ASSERT_TRUE(file);
        image::Mask mask;
        ASSERT_TRUE(file->read_mask(0, mask));
        ASSERT_EQ(mask.width, kMaskWidth);
        EXPECT_EQ(std::count(mask.row(5), mask.row(5) + kMaskWidth / 2, 255), kMaskWidth / 2)
            << kind;
        EXPECT_EQ(std::count(mask.row(5) + kMaskWidth / 2, mask.row(5) + kMaskWidth, 0),
                  kMaskWidth / 2)
            << kind;
    }
    const std::vector<int> one_bit{cv::IMWRITE_PNG_BILEVEL, 1};
    ASSERT_TRUE(cv::imwrite((folder_ / "masks/000000.png").string(), kinds[0], one_bit));
    auto file = PictureFile::find(folder_, "masks");
    image::Mask mask;
    ASSERT_TRUE(file->read_mask(0, mask));
    EXPECT_EQ(std::count(mask.data.begin(), mask.data.end(), 255), kMaskWidth * kMaskHeight / 2);
}

// A palette of two people, and a faint mask with a soft outline, which is nobody for sure.
TEST_F(MasksOnDisk, TellsNumbersFromShades) {
    const auto num_people = [&](const cv::Mat& picture) {
        write("masks/000000.png", picture);
        image::Mask mask;
        auto file = PictureFile::find(folder_, "masks");
        EXPECT_TRUE(file && file->read_mask(0, mask));
        return std::count(mask.data.begin(), mask.data.end(), 255);
    };
    cv::Mat two = half(CV_8UC3, {0, 0, 128}, {0, 0, 0});
    two(cv::Rect(kMaskWidth / 2, 0, kMaskWidth / 2, kMaskHeight / 2)) = cv::Scalar(0, 128, 0);
    EXPECT_EQ(num_people(two), kMaskWidth * kMaskHeight * 3 / 4);
    cv::Mat numbers = half(CV_8UC1, 1, 0);
    for (int i = 0; i < 8; ++i) numbers.at<std::uint8_t>(0, i) = static_cast<std::uint8_t>(i + 1);
    EXPECT_EQ(num_people(numbers), kMaskWidth * kMaskHeight / 2);
    numbers.at<std::uint8_t>(0, 8) = 9;
    EXPECT_EQ(num_people(numbers), 0);
}

// A phone on its side writes an orientation; the calibration is of the pixels as they are stored.
TEST_F(MasksOnDisk, IgnoresTheOrientationOfAJpeg) {
    const cv::Mat picture(48, 64, CV_8UC3, cv::Scalar(10, 80, 200));
    std::vector<std::uint8_t> jpeg;
    ASSERT_TRUE(cv::imencode(".jpg", picture, jpeg));
    // after the start of the image: EXIF with the single tag 0x0112, orientation 6
    const std::vector<std::uint8_t> exif{0xff, 0xe1, 0, 34, 'E', 'x', 'i', 'f', 0, 0,    'M', 'M',
                                         0,    42,   0, 0,  0,   8,   0,   1,   1, 0x12, 0,   3,
                                         0,    0,    0, 1,  0,   6,   0,   0,   0, 0,    0,   0};
    jpeg.insert(jpeg.begin() + 2, exif.begin(), exif.end());
    const cv::Mat turned = cv::imdecode(jpeg, cv::IMREAD_COLOR);
    ASSERT_EQ(turned.cols, 48) << "the EXIF block is not understood";
    fs::create_directories(folder_ / "turned");
    std::ofstream(folder_ / "turned/000000.jpg", std::ios::binary)
        .write(reinterpret_cast<const char*>(jpeg.data()), std::ssize(jpeg));
    auto file = PictureFile::find(folder_, "turned");
    ASSERT_TRUE(file);
    image::YuvImage read;
    ASSERT_TRUE(file->read(0, read));
    EXPECT_EQ(read.width(), 64);
    EXPECT_EQ(file->size()->width, 64);
}

// A phone's video is shown by all programs as its tag says, so a calibration is of these pictures.
TEST_F(MasksOnDisk, HonoursTheRotationTagOfAVideo) {
    cv::Mat picture(kMaskHeight, kMaskWidth, CV_8UC3, cv::Scalar::all(20));
    picture(cv::Rect(0, 0, 20, 10)) = cv::Scalar::all(220);  // at the upper left
    for (const int turn_deg : {0, 90, 180, 270}) {
        const fs::path video = folder_ / cv::format("turned%d.mp4", turn_deg);
        {
            cv::VideoWriter writer(
                video.string(), cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 25.0, picture.size());
            for (int k = 0; k < 3; ++k) writer.write(picture);
        }
        if (turn_deg != 0) test::set_rotation_tag(video, turn_deg);
        auto file = PictureFile::find(folder_, video.stem().string());
        ASSERT_TRUE(file);
        cv::Mat expected = picture;
        if (turn_deg == 90) cv::rotate(picture, expected, cv::ROTATE_90_CLOCKWISE);
        if (turn_deg == 180) cv::rotate(picture, expected, cv::ROTATE_180);
        if (turn_deg == 270) cv::rotate(picture, expected, cv::ROTATE_90_COUNTERCLOCKWISE);
        image::YuvImage read;
        for (const std::size_t k : {0U, 2U, 1U}) {
            ASSERT_TRUE(file->read(k, read));
            ASSERT_EQ(file->size()->width, expected.cols) << turn_deg;
            ASSERT_EQ(read.width(), expected.cols) << turn_deg;
            for (const auto& [x, y] : {std::pair{5, 5}, {-6, 5}, {5, -6}, {-6, -6}}) {
                const int column = x < 0 ? expected.cols + x : x;
                const int row = y < 0 ? expected.rows + y : y;
                EXPECT_NEAR(read.y.at(column, row), expected.at<cv::Vec3b>(row, column)[0], 20)
                    << turn_deg << " degrees, at " << column << ", " << row;
            }
        }
    }
}

TEST_F(MasksOnDisk, NamesTheCureForMasksOfAnotherSize) {
    for (const char* camera : {"a", "b"})
        write(fs::path(camera) / "silhouettes/000000.png", cv::Mat(24, 32, CV_8UC1, cv::Scalar(0)));
    const auto source = RecordingSource::open({.folder = folder_});
    ASSERT_FALSE(source);
    EXPECT_TRUE(RecordingSource::open({.folder = folder_, .ignore_silhouettes = true}));
    EXPECT_THAT(source.error().message, HasSubstr("32x24 px"));
    EXPECT_THAT(source.error().message, HasSubstr("mogrify -filter point -resize '64x48!'"));
}

TEST_F(MasksOnDisk, NamesTheCureForAPlateOfAnotherSize) {
    write("a/background.png", cv::Mat(25, 33, CV_8UC3, cv::Scalar(1, 2, 3)));
    auto source = RecordingSource::open({.folder = folder_});
    ASSERT_TRUE(source);
    EXPECT_TRUE((*source)->has_empty_room(0));
    EXPECT_FALSE((*source)->has_empty_room(1));
    const auto shown =
        (*source)->show_background({0}, [](std::size_t, const auto&) { return true; }, {})[0];
    ASSERT_FALSE(shown);
    EXPECT_THAT(shown.error().message, HasSubstr("background.png"));
    EXPECT_THAT(shown.error().message, HasSubstr("has 33x25 px, but the pictures of this camera"));
    EXPECT_THAT(shown.error().message, HasSubstr("scale it as a whole to 64x48"));
}

TEST_F(MasksOnDisk, PlaysEachNthInstant) {
    auto source = RecordingSource::open({.folder = folder_, .every = 3});
    ASSERT_TRUE(source);
    std::vector<Timestamp> times;
    ASSERT_TRUE((*source)->run({}, [&](CameraFrame frame) {
        if (frame.camera == 0) times.push_back(frame.capture_time);
    }));
    ASSERT_EQ(times.size(), 3u);                          // 0, 3 and 6 of 7
    EXPECT_GE((times[1] - times[0]).count(), 5'000'000);  // three periods, but for a delay
    EXPECT_EQ((*source)->num_passed(), 7u);
}

// A sink that blocks gets every instant: nothing is skipped to catch up.
TEST_F(MasksOnDisk, WaitsForTheSinkWhenAsFastAsPossible) {
    auto source = RecordingSource::open({.folder = folder_, .as_fast_as_possible = true});
    ASSERT_TRUE(source);
    std::vector<Timestamp> times;
    ASSERT_TRUE((*source)->run({}, [&](CameraFrame frame) {
        if (frame.camera == 0) times.push_back(frame.capture_time);
    }));
    ASSERT_EQ(times.size(), 7u);
    for (std::size_t i = 1; i < times.size(); ++i) EXPECT_LT(times[i - 1], times[i]);
}

TEST_F(MasksOnDisk, OfWrongNamesAreNamedWithTheRightOnes) {
    for (const char* camera : {"a", "b"})
        write(fs::path(camera) / "silhouettes/img_0001.png", half(CV_8UC1, 255, 0));
    const auto source = RecordingSource::open({folder_});
    ASSERT_FALSE(source);
    EXPECT_THAT(source.error().message,
                HasSubstr("a/silhouettes: found img_0001.png; wants 000000.png"));
}

TEST_F(MasksOnDisk, OfPeopleInBlackAreRefused) {
    cv::Mat inverted(kMaskHeight, kMaskWidth, CV_8UC1, cv::Scalar(255));
    inverted(cv::Rect(20, 0, 12, 40)) = 0;  // a person who is cut by the upper border
    for (const char* camera : {"a", "b"})
        write(fs::path(camera) / "silhouettes/000000.png", inverted);
    const auto source = RecordingSource::open({folder_});
    ASSERT_FALSE(source);
    EXPECT_THAT(source.error().message, HasSubstr("the masks look inverted"));
    EXPECT_THAT(source.error().message, HasSubstr("import again with --invert-masks"));
    // one camera may be close to somebody
    write("b/silhouettes/000000.png", half(CV_8UC1, 255, 0));
    EXPECT_TRUE(RecordingSource::open({folder_}));
    EXPECT_TRUE(RecordingSource::open({.folder = folder_, .ignore_silhouettes = true}));
}

TEST_F(MasksOnDisk, AMissingCameraIsNamedByItsFolder) {
    fs::remove_all(folder_ / "b");
    const auto source = RecordingSource::open({folder_});
    ASSERT_FALSE(source);
    EXPECT_THAT(source.error().message,
                HasSubstr("/b: no such folder, but rig.toml has a camera 'b'"));
}

// Every length but the whole is truncated. Other files are not judged.
TEST(TruncatedPicture, IsFoundAtEveryLength) {
    const fs::path folder = fs::path(testing::TempDir()) / "truncated_picture";
    fs::create_directories(folder);
    for (const char* name : {"whole.png", "whole.jpg"}) {
        const fs::path whole = folder / name;
        ASSERT_TRUE(cv::imwrite(whole.string(), cv::Mat(48, 64, CV_8UC3, cv::Scalar(1, 80, 200))));
        EXPECT_FALSE(is_truncated_picture(whole)) << name;
        const auto num_bytes = fs::file_size(whole);
        for (std::uintmax_t size = 8; size < num_bytes; ++size) {
            const fs::path part = folder / "part";
            fs::copy_file(whole, part, fs::copy_options::overwrite_existing);
            fs::resize_file(part, size);
            EXPECT_TRUE(is_truncated_picture(part)) << name << " " << size;
        }
        // bytes after the picture do no harm
        std::ofstream(whole, std::ios::app) << "appended by another program";
        EXPECT_FALSE(is_truncated_picture(whole)) << name;
    }
    std::ofstream(folder / "text.png") << "garbage";
    EXPECT_FALSE(is_truncated_picture(folder / "text.png"));
    EXPECT_FALSE(is_truncated_picture(folder / "none.png"));
    fs::remove_all(folder);
}

TEST(TruncatedVideo, IsFoundInEveryContainer) {
    using namespace std::string_literals;
    const std::vector<std::string> whole{
        "RIFF\x10\0\0\0AVI "s + std::string(12, 'x'),
        "\0\0\0\x10"s + "ftypisom\0\0\0\0"s + "\0\0\0\x20mdat"s + std::string(24, 'x'),
        "\x1A\x45\xDF\xA3\x82xx\x18\x53\x80\x67\x40\x10"s + std::string(16, 'x')};
    const fs::path file = fs::path(testing::TempDir()) / "truncated_video";
    const auto is_truncated = [&](const std::string& bytes) {
        std::ofstream(file, std::ios::binary) << bytes;
        return is_truncated_video(file);
    };
    for (const std::string& bytes : whole) {
        EXPECT_FALSE(is_truncated(bytes)) << bytes;
        EXPECT_TRUE(is_truncated(bytes.substr(0, bytes.size() - 2))) << bytes;
    }
    EXPECT_FALSE(is_truncated("RIFF\0\0\0\0AVI xx"s));  // never closed: says nothing
    EXPECT_FALSE(is_truncated("\0\0\0\0mdatxx"s));      // to the end of the file
    EXPECT_FALSE(is_truncated("garbage"));
    fs::remove(file);
    EXPECT_FALSE(is_truncated_video(file));
}

}  // namespace
}  // namespace atrium::capture
