// Soft objects under people's hands.
#include "soft_stage.hpp"
#include "tests/support/sanitized.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace atrium::physics {
namespace {

using physics_test::make_box_mesh;
using physics_test::make_person_mesh;

// A slab of the size of a hand that starts at full speed against a soft ball on the floor.
class SoftBallPushed : public testing::TestWithParam<double> {};

TEST_P(SoftBallPushed, IsNeverPassedThrough) {
    const double speed = GetParam();
    int num_passed = 0;
    const int num_trials = test::kSanitized ? 4 : 20;
    for (int trial = 0; trial < num_trials; ++trial) {
        std::mt19937 random(2000 + trial);
        const auto uniform = [&](double low, double high) {
            return std::uniform_real_distribution<double>(low, high)(random);
        };
        SoftStage stage;
        ASSERT_EQ(stage.world.add_soft(ball_at({0, 0, 0.17})), AddResult::kAdded);
        stage.run(0.5);
        const double y = uniform(-0.04, 0.04), z = uniform(0.12, 0.2);
        const double tilt = uniform(-0.3, 0.3), rest_s = uniform(0.1, 0.13);
        const auto hand_x = [&](double t) {
            return -0.35 + std::clamp(speed * (t - rest_s), 0.0, 0.8);
        };
        double least_ahead = 1e9;
        stage.play(
            0.2 + 0.8 / speed,
            [&](double t) {
                return make_box_mesh(
                    {0.04, 0.10, 0.18},
                    {Eigen::Quaterniond(Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitZ())),
                     {hand_x(t), y, z}},
                    2 + static_cast<int>(random() % 5));
            },
            [&](double t) {
                // A person lags by one mesh period. A ball whose middle is beside the hand has
                // glanced off its edge.
                const Eigen::Vector3d hand(hand_x(t - kMeshPeriodS), y, z);
                const Eigen::Vector3d middle =
                    Eigen::AngleAxisd(-tilt, Eigen::Vector3d::UnitZ()) * (stage.centre() - hand);
                if (std::abs(middle.y()) > 0.07 || std::abs(middle.z()) > 0.11) return;
                least_ahead = std::min(least_ahead, middle.x());
            });
        if (least_ahead <= 0.0) ++num_passed;
        EXPECT_EQ(stage.world.counters().num_not_finite, 0U);
    }
    EXPECT_EQ(num_passed, 0);
}
INSTANTIATE_TEST_SUITE_P(Speeds, SoftBallPushed, testing::Values(0.5, 1.0, 2.0));

TEST(SoftBall, SurvivesAPersonWhoAppearsInIt) {
    SoftStage stage;
    ASSERT_EQ(stage.world.add_soft(ball_at({0.05, 0, 1.2})), AddResult::kAdded);
    double fastest = 0.0;
    double volume = 0.0;
    stage.play(
        2.0,
        [](double) {
            return make_person_mesh({0, 0, 0}, 0.5, 16);
        },
        [&](double) {
            fastest = std::max(fastest, stage.fastest_mps());
            volume = std::max(volume, stage.volume_m3());
        });
    EXPECT_LT(fastest, 12.0);
    EXPECT_LT(volume, 1.2 * 0.022);
    stage.world.remove_person("anna");
    stage.run(3.0);
    EXPECT_LT(stage.centre().z(), 0.2);  // and falls when the person has left
    EXPECT_NEAR(stage.volume_m3(), 0.022, 0.002);
}

TEST(SoftBall, IsLiftedByTwoArmsFromBelow) {
    SoftStage stage;
    ASSERT_EQ(stage.world.add_soft(ball_at({0.0, 0, 0.9})), AddResult::kAdded);
    const auto arms = [](double t) {
        const double z = 0.66 + 0.3 * std::clamp(t - 1.0, 0.0, 1.0);
        geometry::TriangleMesh mesh =
            make_box_mesh({0.5, 0.08, 0.08}, {Eigen::Quaterniond::Identity(), {0, -0.09, z}}, 8);
        geometry::append(
            mesh,
            make_box_mesh({0.5, 0.08, 0.08}, {Eigen::Quaterniond::Identity(), {0, 0.09, z}}, 8));
        return mesh;
    };
    stage.play(3.0, arms);
    EXPECT_GT(stage.centre().z(), 0.96);
    EXPECT_LT(stage.centre().z(), 1.3);
}

TEST(SoftCloth, PartsForAWalkerAndFallsBack) {
    SoftStage stage;
    SoftObject left = curtain_at({0, -0.36, 1.1});
    left.world_from_object.rotation =
        Eigen::AngleAxisd(std::numbers::pi / 2.0, Eigen::Vector3d::UnitZ());
    SoftObject right = left;
    right.id = 51;
    right.world_from_object.translation.y() = 0.36;
    ASSERT_EQ(stage.world.add_soft(left), AddResult::kAdded);
    ASSERT_EQ(stage.world.add_soft(right), AddResult::kAdded);
    stage.run(2.0);
    const std::vector<Eigen::Vector3f> start = stage.soft().positions;
    double furthest = 0.0;
    stage.play(
        4.0,
        [](double t) {
            return make_person_mesh({-1.5 + t, 0, 0}, 0.4, 16);
        },
        [&](double) {
            for (const Eigen::Vector3f& p : stage.soft().positions) {
                furthest = std::max<double>(furthest, std::abs(p.x()));
            }
        });
    EXPECT_GT(furthest, 0.2);
    stage.world.remove_person("anna");
    stage.run(6.0);
    double off = 0.0;
    const SoftState& state = stage.soft();
    for (std::size_t i = 0; i < start.size(); ++i) {
        off = std::max<double>(off, (state.positions[i] - start[i]).norm());
    }
    EXPECT_LT(off, 0.15);
    EXPECT_EQ(stage.world.counters().num_torn, 0U);
}

}  // namespace
}  // namespace atrium::physics
