#include "site_node/refine/patch_scores.hpp"

#include "tests/support/random.hpp"
#include "tests/support/skips.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace atrium::refine {
namespace {

constexpr int kSize = 60;

// Smooth random grey, moved by `shift` columns.
LumaPicture picture(std::uint64_t seed, double shift, bool with_contrast = true) {
    test::Random random(seed);
    std::array<double, 12> phases{};
    for (double& phase : phases) phase = test::between(random, 0.0, 6.28);
    LumaPicture out;
    out.width = out.height = kSize;
    const auto grey = [&](int x, int y) {
        double value = 128.0;
        for (std::size_t k = 0; with_contrast && k < phases.size(); ++k) {
            const double angle = 0.5 * static_cast<double>(k);
            const double along = std::cos(angle) * (x - shift) + std::sin(angle) * y;
            value += 14.0 * std::sin((0.35 + 0.07 * static_cast<double>(k)) * along + phases[k]);
        }
        return static_cast<std::uint32_t>(std::clamp(value, 0.0, 255.0));
    };
    for (int y = 0; y < kSize; ++y) {
        for (int x = 0; x < kSize; ++x)
            out.taps.push_back(grey(x, y) | (grey(x + 1, y) << 8U) | (grey(x, y + 1) << 16U) |
                               (grey(x + 1, y + 1) << 24U));
    }
    out.inside.assign(out.taps.size(), 1);
    return out;
}

PatchPath path(const LumaPicture& in, float from_x, float to_x) {
    PatchPath path;
    path.picture = &in;
    path.first_px = {from_x, 30.0F};
    path.last_px = {to_x, 30.0F};
    path.column_px = {1.0F, 0.1F};
    path.row_px = {-0.1F, 1.0F};
    return path;
}

TEST(PatchScores, AreBestWhereThePicturesAgree) {
    constexpr std::size_t kNumSteps = 17;
    for (const double where : {2.0, 8.0, 13.0}) {
        // the second picture's path moves 16 px relative to the first one's
        const LumaPicture first = picture(1, 0.0);
        const LumaPicture second = picture(1, where - 8.0);
        std::array<float, kNumSteps> scores{};
        const std::array<PatchPath, 2> paths{path(first, 30.0F, 30.0F), path(second, 22.0F, 38.0F)};
        score_depths(paths, {.num = kNumSteps}, scores);
        const auto best = std::max_element(scores.begin(), scores.end()) - scores.begin();
        EXPECT_EQ(best, static_cast<std::ptrdiff_t>(where));
        EXPECT_GT(scores[static_cast<std::size_t>(best)], 0.98F);
        EXPECT_LT(*std::min_element(scores.begin(), scores.end()), 0.5F);
    }
}

TEST(PatchScores, OutvoteOneCameraThatSeesSomethingElse) {
    const LumaPicture first = picture(2, 0.0);
    const LumaPicture second = picture(2, 0.0);
    const LumaPicture other = picture(77, 0.0);
    float score = 0.0F;
    const auto score_of = [&](const std::vector<PatchPath>& paths) {
        score_depths(paths, {}, {&score, 1});
        return score;
    };
    const PatchPath a = path(first, 30, 30), b = path(second, 30, 30), c = path(other, 30, 30);
    const float with_other = score_of({a, b, c});
    EXPECT_FLOAT_EQ(score_of({a, b}), 1.0F);
    EXPECT_EQ(with_other, score_of({c, a, b}));
    // the mean of the pair that agrees and of the better one of the pairs that do not
    EXPECT_NEAR(with_other, 0.5F * (1.0F + score_of({a, c})), 1e-5);
    EXPECT_GT(with_other, score_of({a, c}));
}

TEST(PatchScores, AreUnknownOutsideAndWithoutContrast) {
    LumaPicture first = picture(3, 0.0);
    const LumaPicture grey = picture(3, 0.0, false);
    float score = 0.0F;
    score_depths(std::array{path(first, 30, 30), path(grey, 30, 30)}, {}, {&score, 1});
    EXPECT_EQ(score, kUnknownScore);
    for (const float beside : {-5.0F, 1.0F, 57.5F, 1e9F, std::nanf("")}) {
        score_depths(std::array{path(first, 30, 30), path(first, beside, beside)}, {}, {&score, 1});
        EXPECT_EQ(score, kUnknownScore) << beside;
    }
    first.inside[30 * kSize + 30] = 0;
    score_depths(std::array{path(first, 30, 30), path(first, 31, 31)}, {}, {&score, 1});
    EXPECT_EQ(score, kUnknownScore);
}

TEST(PatchScores, AreWrittenForTheStepsAskedForOnly) {
    const LumaPicture first = picture(1, 0.0);
    const LumaPicture second = picture(1, 1.0);
    const std::array<PatchPath, 2> paths{path(first, 30.0F, 30.0F), path(second, 22.0F, 38.0F)};
    constexpr float kUntouched = 7.0F;
    std::array<float, 16> all{}, some{};
    some.fill(kUntouched);
    score_depths(paths, {.num = 16}, all);
    score_depths(paths, {.num = 16, .first = 1, .stride = 2}, std::span(some).first(12));
    for (std::size_t step = 0; step < some.size(); ++step)
        EXPECT_EQ(some[step], step % 2 == 1 && step < 12 ? all[step] : kUntouched) << step;
}

TEST(PatchScores, AreTheSameForAllInstructionSets) {
    if (image::best_row_code() != image::RowCode::kAvx2) GTEST_SKIP() << test::skip::kNoAvx2;
    test::Random random(4);
    const std::array<LumaPicture, 3> pictures{picture(5, 0.0), picture(5, 1.3), picture(6, 0.0)};
    const auto somewhere = [&] {
        return Eigen::Vector2f(static_cast<float>(test::between(random, -3.0, 62.0)),
                               static_cast<float>(test::between(random, -3.0, 62.0)));
    };
    for (int trial = 0; trial < 300; ++trial) {
        std::vector<PatchPath> paths;
        const int num = test::between(random, 2, 3);
        for (int i = 0; i < num; ++i) {
            PatchPath at;
            at.picture = &pictures[static_cast<std::size_t>(i)];
            at.first_px = somewhere();
            at.last_px = somewhere();
            at.first_depth_m = static_cast<float>(test::between(random, 1.0, 4.0));
            at.last_depth_m = static_cast<float>(test::between(random, 1.0, 4.0));
            at.column_px = 0.03F * somewhere();
            at.row_px = 0.03F * somewhere();
            paths.push_back(at);
        }
        std::array<float, 17> baseline{}, fast{};
        score_depths(paths, {.num = baseline.size()}, baseline, image::RowCode::kBaseline);
        score_depths(paths, {.num = fast.size()}, fast, image::RowCode::kAvx2);
        ASSERT_EQ(baseline, fast) << trial;
    }
}

}  // namespace
}  // namespace atrium::refine
