#include "site_node/segmentation/background_file.hpp"

#include "site_node/segmentation/background_quality.hpp"
#include "tests/unit/segmentation/test_room.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <iterator>

namespace atrium::segmentation {
namespace {

namespace fs = std::filesystem;
using namespace test;
using testing::HasSubstr;

class BackgroundFile : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::path(testing::TempDir()) / ("atrium_background_" + std::to_string(getpid()));
        std::mt19937 random(1);
        room_ = learn(room(62, 34), 7, random);
        room_.mosaic = image::Mosaic::kGB;
        room_.had_people = true;
        ASSERT_TRUE(save_background(room_, folder_ / "deep", "cam1"));
        file_ = background_file(folder_ / "deep", "cam1");
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::string bytes() const {
        std::ifstream stream(file_, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    void write(const std::string& bytes) const {
        std::ofstream(file_, std::ios::binary | std::ios::trunc) << bytes;
    }
    std::string error(const std::string& camera = "cam1") const {
        const auto loaded = load_background(folder_ / "deep", camera);
        return loaded ? "" : loaded.error().message;
    }

    fs::path folder_;
    fs::path file_;
    BackgroundStatistics room_;
};

TEST_F(BackgroundFile, RoundTripKeepsTheModel) {
    const auto loaded = load_background(folder_ / "deep", "cam1");
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_EQ(loaded->width, 62);
    EXPECT_EQ(loaded->height, 34);
    EXPECT_EQ(loaded->mosaic, image::Mosaic::kGB);
    EXPECT_EQ(loaded->num_frames, 7);
    EXPECT_TRUE(loaded->had_people);
    EXPECT_EQ(loaded->luma, room_.luma);
    EXPECT_EQ(loaded->luma_sigma, room_.luma_sigma);
    EXPECT_EQ(loaded->u, room_.u);
    EXPECT_EQ(loaded->v, room_.v);
    EXPECT_EQ(loaded->uu, room_.uu);
    EXPECT_EQ(loaded->uv, room_.uv);
    EXPECT_EQ(loaded->vv, room_.vv);
}

TEST_F(BackgroundFile, OfAnEmptyRoomIsAsOlderProgramsReadIt) {
    EXPECT_EQ(bytes()[8], 2);
    room_.had_people = false;
    ASSERT_TRUE(save_background(room_, folder_ / "deep", "cam1"));
    EXPECT_EQ(bytes()[8], 1);
    const auto loaded = load_background(folder_ / "deep", "cam1");
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_FALSE(loaded->had_people);
}

TEST_F(BackgroundFile, IsReplacedAtomicallyWithoutLeftovers) {
    room_.num_frames = 8;
    ASSERT_TRUE(save_background(room_, folder_ / "deep", "cam1"));
    EXPECT_EQ(load_background(folder_ / "deep", "cam1")->num_frames, 8);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "deep"), {}), 1);
    // a file occupies the path of the folder
    EXPECT_FALSE(save_background(room_, file_ / "inside", "cam1"));
}

TEST_F(BackgroundFile, NamesErrorsOfAFile) {
    EXPECT_EQ(load_background(folder_, "cam9").error().kind, ErrorKind::kNotFound);
    const std::string good = bytes();
    fs::copy_file(file_, background_file(folder_ / "deep", "cam2"));
    EXPECT_THAT(error("cam2"), HasSubstr("belongs to camera 'cam1'"));
    std::string version = good;
    version[8] = 9;
    write(version);
    EXPECT_THAT(error(), HasSubstr("version 9"));
    write("PNG and so on, long enough for a head");
    EXPECT_THAT(error(), HasSubstr("not a background file"));
    write(good + "x");
    EXPECT_THAT(error(), HasSubstr("damaged or truncated"));
    write(good);
    EXPECT_EQ(error(), "");
}

TEST_F(BackgroundFile, RefusesEveryCutAndFlippedByte) {
    const std::string good = bytes();
    for (std::size_t size = 0; size < good.size(); size += size < 80 ? 1 : 97) {
        write(good.substr(0, size));
        EXPECT_NE(error(), "") << size;
    }
    for (std::size_t at = 0; at < good.size(); at += at < 80 ? 1 : 101) {
        std::string bad = good;
        bad[at] = static_cast<char>(bad[at] ^ 0x41);
        write(bad);
        EXPECT_NE(error(), "") << at;
    }
}

// A valid checksum proves nothing about the content. Sizes that do not fit the length are errors.
TEST_F(BackgroundFile, RefusesSizesThatDoNotFitTheLength) {
    for (const std::uint32_t width : {0U, 1U, 60U, 64U, 8194U, 0xffffffffU}) {
        std::string bad = bytes();
        std::memcpy(bad.data() + 8 + 4 + 4 + 4, &width, sizeof width);
        std::uint64_t hash = 14695981039346656037ULL;
        for (std::size_t i = 0; i + 8 < bad.size(); ++i)
            hash = (hash ^ static_cast<std::uint8_t>(bad[i])) * 1099511628211ULL;
        std::memcpy(bad.data() + bad.size() - 8, &hash, sizeof hash);
        const std::string good = bytes();
        write(bad);
        EXPECT_THAT(error(), testing::AnyOf(HasSubstr("is damaged"), HasSubstr("length"))) << width;
        write(good);
    }
}

TEST(BackgroundQuality, ReportsNoiseAndTestablePixels) {
    std::mt19937 random(2);
    image::YuvImage scene = plain(100, 40, {100, 128, 128});
    for (int y = 0; y < 40; ++y) {
        std::fill_n(scene.y.row(y), 10, 5);         // dark
        std::fill_n(scene.y.row(y) + 10, 20, 255);  // clipped
    }
    const BackgroundQuality quality = background_quality(learn(scene, 60, random, 3.0), {});
    EXPECT_NEAR(quality.noise, 3.0, 0.6);
    EXPECT_NEAR(quality.coverage, 0.7, 0.01);
}

}  // namespace
}  // namespace atrium::segmentation
