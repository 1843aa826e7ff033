#include "site_node/refine/smooth_depths.hpp"

#include "tests/support/random.hpp"
#include "tests/support/shapes/box_mesh.hpp"
#include "tests/support/skips.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace atrium::refine {
namespace {

using image::RowCode;

constexpr float kFirstOutlier_m = 0.08F;

// On a box of 50 x 50 x 40 cm.
class DepthsOfABox : public testing::Test {
protected:
    void SetUp() override {
        SerialExecutor executor;
        surfels_.sample(test::box_mesh({0, 0, 0}, {0.5, 0.5, 0.4}), {}, {}, executor);
        ASSERT_GT(surfels_.size(), 2000U);
        sut_.assign(surfels_);
    }
    // Says so at each surfel with this probability.
    void find(double share, float depth_m) {
        for (std::size_t i = 0; i < surfels_.size(); ++i) {
            if (test::between(random_, 0.0, 1.0) > share) continue;
            sut_.found_m[i] = depth_m;
            sut_.weights[i] = 1.0F;
        }
    }

    test::Random random_{3};
    SmoothDepthsOptions options_;
    Surfels surfels_;
    SmoothDepths sut_;
};

TEST_F(DepthsOfABox, StayOnTheHullWhereNothingIsKnown) {
    sut_.solve(options_, 20, kFirstOutlier_m);
    for (const float depth : sut_.depths_m) EXPECT_EQ(depth, 0.0F);
}

TEST_F(DepthsOfABox, FollowWhatMostFound) {
    constexpr float kTrue_m = 0.03F;
    find(0.5, kTrue_m);
    for (std::size_t i = 0; i < surfels_.size(); ++i)
        if (sut_.weights[i] > 0.0F && test::between(random_, 0.0, 1.0) < 0.2)
            sut_.found_m[i] = 0.1F;  // a fifth is wrong
    sut_.depths_m = sut_.found_m;
    sut_.solve(options_, 40, kFirstOutlier_m);
    double off_m = 0.0;
    for (const float depth : sut_.depths_m) off_m += std::abs(depth - kTrue_m);
    EXPECT_LT(off_m / static_cast<double>(surfels_.size()), 0.004);
}

TEST_F(DepthsOfABox, AreThoseOfBeforeWhereNothingIsFound) {
    constexpr float kBefore_m = 0.03F;
    sut_.earlier_m.assign(surfels_.size(), kBefore_m);
    sut_.earlier_weights.assign(surfels_.size(), 1.0F);
    sut_.depths_m = sut_.earlier_m;
    sut_.solve(options_, 20, kFirstOutlier_m);
    for (const float depth : sut_.depths_m) EXPECT_NEAR(depth, kBefore_m, 0.001F);
}

TEST_F(DepthsOfABox, FollowWhatIsFoundNowWhereTheSurfaceJumped) {
    constexpr float kNow_m = 0.06F;
    find(0.7, kNow_m);
    for (std::size_t i = 0; i < surfels_.size(); ++i) {
        sut_.earlier_m[i] = 0.01F;
        sut_.earlier_weights[i] = 1.0F;
        sut_.depths_m[i] = sut_.weights[i] > 0.0F ? sut_.found_m[i] : sut_.earlier_m[i];
    }
    sut_.solve(options_, 20, kFirstOutlier_m);
    double off_m = 0.0;
    for (const float depth : sut_.depths_m) off_m += std::abs(depth - kNow_m);
    EXPECT_LT(off_m / static_cast<double>(surfels_.size()), 0.006);
}

TEST_F(DepthsOfABox, AreHeldOnTheHull) {
    find(1.0, 0.03F);
    sut_.is_held[100] = 1;
    sut_.solve(options_, 40, kFirstOutlier_m);
    EXPECT_LT(sut_.depths_m[100], 0.003F);
    EXPECT_GT(sut_.depths_m[1500], 0.02F);
}

TEST_F(DepthsOfABox, LeaveRoomForBothSidesOfAPlate) {
    SerialExecutor executor;
    surfels_.sample(test::box_mesh({0, 0, 0}, {0.5, 0.5, 0.04}), {}, {}, executor);
    sut_.assign(surfels_);
    find(1.0, 0.06F);
    sut_.solve(options_, 40, kFirstOutlier_m);
    for (std::size_t i = 0; i < surfels_.size(); ++i)
        EXPECT_LE(sut_.depths_m[i], 0.45F * surfels_[i].thickness_m + 1e-6F);
}

TEST_F(DepthsOfABox, AreTheSameForAllInstructionSets) {
    if (image::best_row_code() != RowCode::kAvx2) GTEST_SKIP() << test::skip::kNoAvx2;
    for (std::size_t i = 0; i < surfels_.size(); ++i) {
        sut_.found_m[i] = static_cast<float>(test::between(random_, 0.0, 0.1));
        sut_.weights[i] = static_cast<float>(test::between(random_, -1.0, 1.0));
        sut_.is_held[i] = test::between(random_, 0, 9) == 0 ? 1 : 0;
        sut_.earlier_m[i] = static_cast<float>(test::between(random_, 0.0, 0.1));
        sut_.earlier_weights[i] = static_cast<float>(test::between(random_, -1.0, 1.0));
    }
    sut_.depths_m = sut_.found_m;
    SmoothDepths fast = sut_;
    sut_.solve(options_, 10, kFirstOutlier_m, RowCode::kBaseline);
    fast.solve(options_, 10, kFirstOutlier_m, RowCode::kAvx2);
    EXPECT_EQ(sut_.depths_m, fast.depths_m);
}

TEST(SmoothDepths, OfSurfelsWithoutNeighboursAreThoseFound) {
    SurfelOptions lonely;
    lonely.neighbourhood_m = 0.001F;
    SerialExecutor executor;
    Surfels surfels;
    surfels.sample(test::box_mesh({0, 0, 0}, {0.2, 0.2, 0.4}), {}, lonely, executor);
    SmoothDepths sut;
    sut.assign(surfels);
    for (std::size_t i = 0; i < surfels.size(); ++i) {
        ASSERT_TRUE(surfels.neighbours(i).empty());
        sut.found_m[i] = 0.02F;
        sut.weights[i] = i % 2 == 0 ? 1.0F : 0.0F;
    }
    sut.depths_m = sut.found_m;
    sut.solve({}, 10, kFirstOutlier_m);
    for (std::size_t i = 0; i < surfels.size(); ++i)
        EXPECT_NEAR(sut.depths_m[i], i % 2 == 0 ? 0.02F : 0.0F, 0.001F) << i;
}

}  // namespace
}  // namespace atrium::refine
