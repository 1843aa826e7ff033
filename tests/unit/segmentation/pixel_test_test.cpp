#include "site_node/segmentation/pixel_test.hpp"

#include "tests/support/shapes/whole_mask.hpp"
#include "tests/support/skips.hpp"

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
        fill(values, low, high);
    }

    template <typename Values>
    void fill(Values& values, int low, int high) {
        for (auto& value : values)
            value = static_cast<std::decay_t<decltype(value)>>(in(low, high));
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

void set_ratios(BackgroundModel& model, Random& random, int most) {
    for (RoomLook& look : model.looks) {
        for (auto* ratio : {&look.ratio_u, &look.ratio_v}) random.fill(*ratio, -most, most);
    }
}

void set_hue_noise(BackgroundModel& model, Random& random, int most) {
    for (HueNoise& noise : model.hue_noise) {
        for (auto* factor : {&noise.whiten_u, &noise.whiten_uv, &noise.whiten_v})
            random.fill(*factor, -most, most);
    }
}

void let_all_luma_pass(BackgroundModel& model) {
    for (RoomLook& look : model.looks) {
        look.luma_low = {};
        for (auto& row : look.luma_high) row.fill(255);
    }
}

// Makes every luma of this pixel fail.
void forbid(BackgroundModel& model, int x, int y) {
    RoomLook& look =
        model.looks[model.first_group(y / 2) + static_cast<std::size_t>(x / kPixelsPerGroup)];
    look.luma_low[static_cast<std::size_t>(y % 2)][static_cast<std::size_t>(x % kPixelsPerGroup)] =
        255;
}

// A model with arbitrary values. Learned models have milder ones.
BackgroundModel any_model(int width, int height, Random& random) {
    BackgroundModel model;
    model.room.width = width;
    model.room.height = height;
    model.resize_groups();
    for (RoomLook& look : model.looks) {
        for (auto& row : look.luma_low) random.fill(row, 0, 255);
        for (auto& row : look.luma_high) random.fill(row, 0, 255);
    }
    set_ratios(model, random, 32767);
    set_hue_noise(model, random, 32767);
    model.max_distance_sq = random.in(0, 80000000);
    model.min_colour_luma = static_cast<std::int16_t>(random.in(0, 1020));
    limit_near_hues(model);
    return model;
}

TEST(PixelTest, GivesTheSameBitsForAllInstructionSets) {
    if (best_instruction_set() == InstructionSet::kBaseline)
        GTEST_SKIP() << atrium::test::skip::kNoAvx2;
    Random random(7);
    int num_foreground = 0;
    int num_background = 0;
    for (int round = 0; round < 60; ++round) {
        const int width = 2 * random.in(1, 70);
        const int height = 2 * random.in(1, 9);
        // dark, bright and arbitrary pictures
        const image::YuvImage frame =
            picture(width, height, random, round % 3 == 1 ? 230 : 0, round % 3 == 2 ? 30 : 255);
        const BackgroundModel model = any_model(width, height, random);
        const auto gain =
            static_cast<std::int16_t>(round % 4 == 0 ? kUnitGain : random.in(0, 32767));
        std::vector<std::uint8_t> baseline(frame.y.data.size(), 1);
        std::vector<std::uint8_t> avx2(frame.y.data.size(), 2);
        test::test_rows(
            frame, model, gain, InstructionSet::kBaseline, {0, height}, baseline.data());
        test::test_rows(frame, model, gain, InstructionSet::kAvx2, {0, height}, avx2.data());
        ASSERT_EQ(baseline, avx2) << width << "x" << height << ", gain " << gain;
        for (const std::uint8_t value : baseline)
            (value == 255 ? num_foreground : num_background) += 1;
    }
    EXPECT_GT(num_foreground, 1000);
    EXPECT_GT(num_background, 1000);
}

// The same, with limits that let much of a picture pass.
TEST(PixelTest, GivesTheSameBitsWhereChromaDecides) {
    if (best_instruction_set() == InstructionSet::kBaseline)
        GTEST_SKIP() << atrium::test::skip::kNoAvx2;
    Random random(8);
    for (int round = 0; round < 40; ++round) {
        const int width = 2 * random.in(1, 70);
        const image::YuvImage frame = picture(width, 4, random, 0, 249);
        BackgroundModel model = any_model(width, 4, random);
        let_all_luma_pass(model);
        set_ratios(model, random, 3000);
        std::vector<std::uint8_t> baseline(frame.y.data.size(), 1);
        std::vector<std::uint8_t> avx2(frame.y.data.size(), 2);
        test::test_rows(
            frame, model, kUnitGain, InstructionSet::kBaseline, {0, 4}, baseline.data());
        test::test_rows(frame, model, kUnitGain, InstructionSet::kAvx2, {0, 4}, avx2.data());
        ASSERT_EQ(baseline, avx2) << width;
    }
}

// If the hue is near the room's, the AVX2 code does not look at its noise.
TEST(PixelTest, GivesTheSameBitsAtTheChromaLimit) {
    if (best_instruction_set() == InstructionSet::kBaseline)
        GTEST_SKIP() << atrium::test::skip::kNoAvx2;
    Random random(10);
    int num_foreground = 0;
    int num_background = 0;
    for (int round = 0; round < 400; ++round) {
        const int width = 32 * random.in(1, 3);
        BackgroundModel model = any_model(width, 4, random);
        let_all_luma_pass(model);
        set_ratios(model, random, 200);
        const int most = random.in(500, 32767);
        set_hue_noise(model, random, most);
        model.min_colour_luma = 0;
        // puts the smallest deviations that count at some grey levels
        const int limit = random.in(1, 30) * most / 512;
        model.max_distance_sq = limit * limit;
        limit_near_hues(model);
        image::YuvImage frame = picture(width, 4, random, 0, 249);
        const int reach = random.in(1, 20);
        random.fill(frame.u.data, frame.u.data.size(), 128 - reach, 128 + reach);
        random.fill(frame.v.data, frame.v.data.size(), 128 - reach, 128 + reach);
        std::vector<std::uint8_t> baseline(frame.y.data.size(), 1);
        std::vector<std::uint8_t> avx2(frame.y.data.size(), 2);
        test::test_rows(
            frame, model, kUnitGain, InstructionSet::kBaseline, {0, 4}, baseline.data());
        test::test_rows(frame, model, kUnitGain, InstructionSet::kAvx2, {0, 4}, avx2.data());
        ASSERT_EQ(baseline, avx2) << width << ", round " << round;
        for (const std::uint8_t value : baseline)
            (value == 255 ? num_foreground : num_background) += 1;
    }
    EXPECT_GT(num_foreground, 1000);
    EXPECT_GT(num_background, 1000);
}

TEST(PixelTest, ReportsCellsWithForeground) {
    Random random(11);
    for (int round = 0; round < 200; ++round) {
        const int width = 2 * random.in(1, 70);
        BackgroundModel model = any_model(width, 2, random);
        let_all_luma_pass(model);
        model.max_distance_sq = 1 << 30;
        for (int i = random.in(0, 3); i > 0; --i)
            forbid(model, random.in(0, width - 1), random.in(0, 1));
        const image::YuvImage frame = picture(width, 2, random, 0, 249);
        for (const InstructionSet code : {InstructionSet::kBaseline, best_instruction_set()}) {
            std::vector<std::uint8_t> out(frame.y.data.size());
            std::vector<std::uint8_t> cells(static_cast<std::size_t>(width / kTestCell + 1), 0);
            test_part(frame,
                      model,
                      kUnitGain,
                      code,
                      {0, 0, width, 2},
                      {out.data(), out.data() + width, cells.data()});
            std::vector<std::uint8_t> expected(cells.size(), 0);
            for (int i = 0; i < 2 * width; ++i)
                expected[static_cast<std::size_t>(i % width / kTestCell)] |=
                    out[static_cast<std::size_t>(i)] & 1;
            ASSERT_EQ(cells, expected) << width;
        }
    }
}

// A strip of rows gives the same result as these rows of the whole picture.
TEST(PixelTest, TestsRowsIndependently) {
    Random random(9);
    const image::YuvImage frame = picture(50, 12, random, 0, 255);
    const BackgroundModel model = any_model(50, 12, random);
    std::vector<std::uint8_t> all(50 * 12);
    std::vector<std::uint8_t> part(50 * 4);
    test::test_rows(frame, model, kUnitGain, best_instruction_set(), {0, 12}, all.data());
    test::test_rows(frame, model, kUnitGain, best_instruction_set(), {6, 10}, part.data());
    EXPECT_TRUE(std::equal(part.begin(), part.end(), all.begin() + 50 * 6));
}

}  // namespace
}  // namespace atrium::segmentation
