#include "site_node/segmentation/pixel_test.hpp"

#include <gtest/gtest.h>

#include <random>

namespace atrium::segmentation {
namespace {

class Random {
public:
    explicit Random(unsigned seed) : engine_(seed) {}
    int in(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine_); }
    template <typename Value>
    void fill(std::vector<Value>& values, std::size_t size, int low, int high) {
        values.resize(size);
        for (Value& value : values) value = static_cast<Value>(in(low, high));
    }

private:
    std::mt19937 engine_;
};

image::YuvImage picture(int width, int height, Random& random, int dark, int bright) {
    image::YuvImage frame{image::Plane(width, height),
                          image::Plane(width / 2, height / 2),
                          image::Plane(width / 2, height / 2)};
    random.fill(frame.y.data, frame.y.data.size(), dark, bright);
    random.fill(frame.u.data, frame.u.data.size(), 0, 255);
    random.fill(frame.v.data, frame.v.data.size(), 0, 255);
    return frame;
}

// Any values at all; a model that was learned is tamer.
BackgroundModel any_model(int width, int height, Random& random) {
    BackgroundModel model;
    model.room.width = width;
    model.room.height = height;
    const auto num_pixels = static_cast<std::size_t>(width * height);
    random.fill(model.luma_low, num_pixels, 0, 255);
    random.fill(model.luma_high, num_pixels, 0, 255);
    for (auto* plane :
         {&model.ratio_u, &model.ratio_v, &model.whiten_u, &model.whiten_uv, &model.whiten_v})
        random.fill(*plane, num_pixels / 4, -32767, 32767);
    model.max_distance_sq = random.in(0, 80000000);
    model.min_colour_luma = static_cast<std::int16_t>(random.in(0, 1020));
    return model;
}

TEST(PixelTest, AllInstructionSetsGiveTheSameBits) {
    if (best_instruction_set() == InstructionSet::kBaseline)
        GTEST_SKIP() << "this processor has no AVX2";
    Random random(7);
    int num_foreground = 0;
    int num_background = 0;
    for (int round = 0; round < 60; ++round) {
        const int width = 2 * random.in(1, 70);
        const int height = 2 * random.in(1, 9);
        // dark, bright and all kinds of pictures
        const image::YuvImage frame =
            picture(width, height, random, round % 3 == 1 ? 230 : 0, round % 3 == 2 ? 30 : 255);
        const BackgroundModel model = any_model(width, height, random);
        const auto gain =
            static_cast<std::int16_t>(round % 4 == 0 ? kUnitGain : random.in(0, 32767));
        std::vector<std::uint8_t> baseline(frame.y.data.size(), 1);
        std::vector<std::uint8_t> avx2(frame.y.data.size(), 2);
        test_rows(frame, model, gain, InstructionSet::kBaseline, {0, height}, baseline.data());
        test_rows(frame, model, gain, InstructionSet::kAvx2, {0, height}, avx2.data());
        ASSERT_EQ(baseline, avx2) << width << "x" << height << ", gain " << gain;
        for (const std::uint8_t value : baseline)
            (value == 255 ? num_foreground : num_background) += 1;
    }
    EXPECT_GT(num_foreground, 1000);
    EXPECT_GT(num_background, 1000);
}

// The same with limits that let much of a picture pass.
TEST(PixelTest, AllInstructionSetsAgreeWhereChromaDecides) {
    if (best_instruction_set() == InstructionSet::kBaseline)
        GTEST_SKIP() << "this processor has no AVX2";
    Random random(8);
    for (int round = 0; round < 40; ++round) {
        const int width = 2 * random.in(1, 70);
        const image::YuvImage frame = picture(width, 4, random, 0, 249);
        BackgroundModel model = any_model(width, 4, random);
        std::fill(model.luma_low.begin(), model.luma_low.end(), std::uint8_t{0});
        std::fill(model.luma_high.begin(), model.luma_high.end(), std::uint8_t{255});
        for (auto* plane : {&model.ratio_u, &model.ratio_v})
            random.fill(*plane, plane->size(), -3000, 3000);
        std::vector<std::uint8_t> baseline(frame.y.data.size(), 1);
        std::vector<std::uint8_t> avx2(frame.y.data.size(), 2);
        test_rows(frame, model, kUnitGain, InstructionSet::kBaseline, {0, 4}, baseline.data());
        test_rows(frame, model, kUnitGain, InstructionSet::kAvx2, {0, 4}, avx2.data());
        ASSERT_EQ(baseline, avx2) << width;
    }
}

// A strip of rows is the same part of the whole.
TEST(PixelTest, RowsAreTestedByThemselves) {
    Random random(9);
    const image::YuvImage frame = picture(50, 12, random, 0, 255);
    const BackgroundModel model = any_model(50, 12, random);
    std::vector<std::uint8_t> all(50 * 12);
    std::vector<std::uint8_t> part(50 * 4);
    test_rows(frame, model, kUnitGain, best_instruction_set(), {0, 12}, all.data());
    test_rows(frame, model, kUnitGain, best_instruction_set(), {6, 10}, part.data());
    EXPECT_TRUE(std::equal(part.begin(), part.end(), all.begin() + 50 * 6));
}

}  // namespace
}  // namespace atrium::segmentation
