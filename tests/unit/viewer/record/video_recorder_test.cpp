#include "viewer/record/video_recorder.hpp"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <vector>

namespace atrium::viewer {
namespace {

constexpr std::array<std::uint8_t, 4> kBlack{0, 0, 0, 255};
constexpr std::array<std::uint8_t, 4> kRed{250, 10, 20, 255};

// Keeps the last picture.
class KeptVideo final : public VideoFile {
public:
    explicit KeptVideo(std::vector<std::uint8_t>& kept) : kept_(kept) {}
    Expected<void> set(std::span<const std::uint8_t> rgba) override {
        kept_.assign(rgba.begin(), rgba.end());
        return {};
    }
    Expected<void> write() override { return {}; }
    Expected<void> finish() override { return {}; }

private:
    std::vector<std::uint8_t>& kept_;
};

// A video of 64 x 64 of one red picture.
class VideoShape : public ::testing::Test {
protected:
    void record(int width, int height) {
        const VideoFormat format{.file = {}, .fps = 30.0, .width = kSide, .height = kSide};
        const auto recorder = VideoRecorder::start(format, std::make_unique<KeptVideo>(kept_));
        const auto now = VideoRecorder::Clock::now();
        ASSERT_TRUE(recorder->wants_picture(now));
        renderer::RenderedPicture picture{.width = width, .height = height, .rgba = {}};
        for (int i = 0; i < width * height; ++i)
            picture.rgba.insert(picture.rgba.end(), kRed.begin(), kRed.end());
        recorder->offer(std::move(picture), now);
        ASSERT_TRUE(recorder->finish());
        ASSERT_EQ(kept_.size(), std::size_t{4} * kSide * kSide);
    }
    std::array<std::uint8_t, 4> pixel(int x, int y) const {
        std::array<std::uint8_t, 4> found{};
        const std::size_t at = 4 * static_cast<std::size_t>(y * kSide + x);
        for (std::size_t i = 0; i < found.size(); ++i) found[i] = kept_[at + i];
        return found;
    }
    static constexpr int kSide = 64;
    static constexpr int kLast = kSide - 1;
    static constexpr int kHalf = kSide / 2;
    std::vector<std::uint8_t> kept_;
};

TEST_F(VideoShape, WideWindowHasBarsAboveAndBelow) {
    record(200, 100);
    for (const int y : {0, 15, 48, kLast}) EXPECT_EQ(pixel(kHalf, y), kBlack) << y;
    for (const int y : {16, kHalf, 47}) EXPECT_EQ(pixel(kHalf, y), kRed) << y;
    EXPECT_EQ(pixel(0, kHalf), kRed);
    EXPECT_EQ(pixel(kLast, kHalf), kRed);
}

TEST_F(VideoShape, SmallNarrowWindowIsEnlargedBetweenBars) {
    record(10, 20);
    for (const int x : {0, 15, 48, kLast}) EXPECT_EQ(pixel(x, kHalf), kBlack) << x;
    for (const int x : {16, kHalf, 47}) EXPECT_EQ(pixel(x, kHalf), kRed) << x;
    EXPECT_EQ(pixel(kHalf, 0), kRed);
    EXPECT_EQ(pixel(kHalf, kLast), kRed);
}

TEST_F(VideoShape, OddSizeHasNoBars) {
    record(65, 66);
    for (const int at : {0, kLast}) {
        EXPECT_EQ(pixel(at, kHalf), kRed);
        EXPECT_EQ(pixel(kHalf, at), kRed);
    }
}

}  // namespace
}  // namespace atrium::viewer
