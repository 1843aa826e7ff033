#include "viewer/scene/texture_library.hpp"

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <map>
#include <string>
#include <thread>

namespace atrium::viewer {
namespace {

namespace fs = std::filesystem;

// A folder with a picture of 6 x 4 pixels in several formats.
class TextureLibraryTest : public testing::Test {
protected:
    void SetUp() override {
        fs::create_directories(root_ / "in");
        cv::Mat bgr(4, 6, CV_8UC3, cv::Scalar(10, 20, 200));
        bgr.at<cv::Vec3b>(0, 0) = {255, 0, 0};
        ASSERT_TRUE(cv::imwrite((root_ / "in/rgb.png").string(), bgr));
        ASSERT_TRUE(cv::imwrite((root_ / "in/photo.jpg").string(), bgr));
        ASSERT_TRUE(cv::imwrite((root_ / "outside.png").string(), bgr));
        ASSERT_TRUE(cv::imwrite((root_ / "in/alpha.png").string(),
                                cv::Mat(4, 6, CV_8UC4, cv::Scalar(10, 20, 200, 40))));
        ASSERT_TRUE(cv::imwrite((root_ / "in/deep.png").string(),
                                cv::Mat(4, 6, CV_16UC1, cv::Scalar(0x8080))));
    }
    void TearDown() override { fs::remove_all(root_); }

    void write(const std::string& name, const std::string& bytes) const {
        std::ofstream(root_ / "in" / name, std::ios::binary) << bytes;
    }
    std::string read(const std::string& name) const {
        std::ifstream stream(root_ / "in" / name, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    ErrorKind failure_of(const std::string& name) const {
        const auto picture = read_texture(root_ / "in" / name);
        EXPECT_FALSE(picture) << name;
        if (picture) return ErrorKind::kInternal;
        EXPECT_NE(picture.error().message.find(name), std::string::npos);
        return picture.error().kind;
    }
    // Waits until `count` pictures have arrived. Otherwise the test's time limit ends it.
    static std::map<std::string, renderer::TexturePicture> wait_for(TextureLibrary& library,
                                                                    std::size_t count) {
        std::map<std::string, renderer::TexturePicture> all;
        while (all.size() < count) {
            for (auto& [name, picture] : library.take()) all[name] = std::move(picture);
            std::this_thread::yield();
        }
        return all;
    }

    const fs::path root_ =
        fs::temp_directory_path() / ("atrium-textures-" + std::to_string(getpid()));
};

TEST_F(TextureLibraryTest, ReadsPicturesAsRgbaFromTheTop) {
    const auto rgb = read_texture(root_ / "in/rgb.png");
    ASSERT_TRUE(rgb) << rgb.error().message;
    EXPECT_EQ(rgb->width, 6);
    EXPECT_EQ(rgb->height, 4);
    ASSERT_EQ(rgb->rgba.size(), 96U);
    EXPECT_EQ(std::vector(rgb->rgba.begin(), rgb->rgba.begin() + 8),
              (std::vector<std::uint8_t>{0, 0, 255, 255, 200, 20, 10, 255}));
    const auto alpha = read_texture(root_ / "in/alpha.png");
    ASSERT_TRUE(alpha);
    EXPECT_EQ(alpha->rgba[3], 40);
    const auto deep = read_texture(root_ / "in/deep.png");
    ASSERT_TRUE(deep) << deep.error().message;
    EXPECT_EQ(deep->rgba[0], 0x80);
    const auto photo = read_texture(root_ / "in/photo.jpg");
    ASSERT_TRUE(photo);
    EXPECT_EQ(photo->width, 6);
    EXPECT_NEAR(photo->rgba[4 * 23], 200, 30);
}

TEST_F(TextureLibraryTest, RefusesMissingDamagedOrTooLargePictures) {
    EXPECT_EQ(failure_of("none.png"), ErrorKind::kNotFound);
    write("text.png", "not a picture");
    EXPECT_EQ(failure_of("text.png"), ErrorKind::kInvalidData);
    write("empty.png", "");
    EXPECT_EQ(failure_of("empty.png"), ErrorKind::kInvalidData);
    const std::string whole = read("rgb.png");
    write("cut.png", whole.substr(0, whole.size() / 2));
    EXPECT_EQ(failure_of("cut.png"), ErrorKind::kInvalidData);
    // 60,000 x 60,000 pixels according to the header, refused before any decoding
    std::string huge = whole;
    huge.replace(16, 8, std::string("\0\0\xEA\x60\0\0\xEA\x60", 8));
    write("huge.png", huge);
    EXPECT_EQ(failure_of("huge.png"), ErrorKind::kInvalidData);
    std::string wide = read("photo.jpg");
    const std::size_t frame = wide.find("\xFF\xC0");
    ASSERT_NE(frame, std::string::npos);
    wide.replace(frame + 5, 4, "\xEA\x60\xEA\x60");
    write("huge.jpg", wide);
    EXPECT_EQ(failure_of("huge.jpg"), ErrorKind::kInvalidData);
    const auto small = read_texture(root_ / "in/rgb.png", {.max_file_bytes = 16});
    ASSERT_FALSE(small);
    EXPECT_EQ(small.error().kind, ErrorKind::kInvalidData);
}

TEST_F(TextureLibraryTest, SurvivesEveryTruncationAndChangedByte) {
    for (const char* name : {"alpha.png", "photo.jpg"}) {
        const std::string whole = read(name);
        for (std::size_t i = 0; i < whole.size(); ++i) {
            write("part.png", whole.substr(0, i));
            (void)read_texture(root_ / "in/part.png");
            std::string changed = whole;
            changed[i] = static_cast<char>(changed[i] ^ 0x5A);
            write("part.png", changed);
            const auto picture = read_texture(root_ / "in/part.png");
            if (!picture) continue;
            EXPECT_EQ(picture->rgba.size(),
                      std::size_t{4} * static_cast<std::size_t>(picture->width * picture->height));
        }
    }
}

TEST_F(TextureLibraryTest, DeliversEachPictureOnceAndStaysInItsFolder) {
    TextureLibrary library(root_ / "in");
    for (const char* bad : {"none.png", "../outside.png", "/etc/hostname", "in/.././rgb.png"})
        library.want(bad);
    library.want("rgb.png");
    library.want("rgb.png");
    library.want("alpha.png");
    // the thread reads in order: when the last has arrived, so have all others
    const auto all = wait_for(library, 2);
    EXPECT_TRUE(all.contains("rgb.png"));
    EXPECT_TRUE(all.contains("alpha.png"));
    library.want("rgb.png");
    EXPECT_TRUE(library.take().empty());
    library.forget();
    library.want("rgb.png");
    EXPECT_EQ(wait_for(library, 1).begin()->first, "rgb.png");
}

TEST_F(TextureLibraryTest, HoldsNoMorePixelsThanItsLimit) {
    ASSERT_TRUE(cv::imwrite((root_ / "in/tiny.png").string(), cv::Mat(1, 2, CV_8UC1, 7)));
    TextureLibrary library(root_ / "in", {.max_pixels = 50});
    for (const char* name : {"rgb.png", "alpha.png", "photo.jpg", "tiny.png"}) library.want(name);
    // read in order: the third of 24 pixels exceeds the limit, and smaller ones still fit
    const auto all = wait_for(library, 3);
    EXPECT_TRUE(all.contains("tiny.png"));
    EXPECT_FALSE(all.contains("photo.jpg"));
}

TEST_F(TextureLibraryTest, ReadsAChangedPictureAgainWhenTheServerHasIt) {
    TextureLibrary library(root_ / "in", {.max_pixels = 50});
    library.want("rgb.png");
    EXPECT_EQ(wait_for(library, 1).at("rgb.png").width, 6);
    auto now = FileVersions::Clock::now();
    const auto look_again = [&] {
        now += FileVersions::kPeriod;
        auto loaded = library.take(now);
        while (!library.is_idle())
            for (auto& texture : library.take(now)) loaded.push_back(std::move(texture));
        return loaded;
    };
    // 6 x 8 pixels would exceed the limit together with those that they replace
    ASSERT_TRUE(cv::imwrite((root_ / "in/rgb.png").string(), cv::Mat(8, 6, CV_8UC1, 7)));
    EXPECT_TRUE(look_again().empty()) << "nobody says that it has changed";
    library.expect("rgb.png", fingerprint_of(root_ / "in/rgb.png", 10'000));
    const auto loaded = look_again();
    ASSERT_EQ(loaded.size(), 1U);
    EXPECT_EQ(loaded.front().second.height, 8);
    EXPECT_FALSE(library.is_different("rgb.png"));
    library.expect("rgb.png", {1, 1});
    EXPECT_TRUE(look_again().empty());
    EXPECT_TRUE(library.is_different("rgb.png"));
    write("rgb.png", "half of a pict");
    EXPECT_TRUE(look_again().empty());
    EXPECT_TRUE(library.is_different("rgb.png"));
    EXPECT_FALSE(library.is_missing("rgb.png")) << "the picture before is still drawn";
}

}  // namespace
}  // namespace atrium::viewer
