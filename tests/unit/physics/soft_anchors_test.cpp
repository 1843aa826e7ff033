// Objects that hang on ropes and cloths.
#include "soft_stage.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace atrium::physics {
namespace {

constexpr std::uint32_t kWeight = 7;
constexpr double kRopeM = 1.2;
constexpr double kRopeKg = 0.3;
constexpr double kBallM = 0.12;

// A rope from `top`, `slant_rad` off the vertical. A ball hangs by its skin at the end.
void add_pendulum(SoftStage& stage, const Eigen::Vector3d& top, double mass_kg, double slant_rad) {
    const Eigen::Quaterniond turned(
        Eigen::AngleAxisd(0.5 * std::numbers::pi - slant_rad, Eigen::Vector3d::UnitY()));
    const Eigen::Vector3d along = turned * Eigen::Vector3d::UnitX();
    RigidObject ball{.id = kWeight, .shape = ObjectShape::kSphere, .mass_kg = mass_kg};
    ball.size_m = Eigen::Vector3d::Constant(kBallM);
    ball.world_from_object.translation = top + (kRopeM + 0.5 * kBallM) * along;
    ASSERT_EQ(stage.world.add(ball), AddResult::kAdded);
    SoftObject rope = rope_at(top + 0.5 * kRopeM * along);
    rope.size_m = {kRopeM, 0.02, kRopeM};
    rope.mass_kg = kRopeKg;
    rope.world_from_object.rotation = turned;
    rope.pins = {{PinPlace::kLeft}, {.place = PinPlace::kRight, .object_id = kWeight}};
    ASSERT_EQ(stage.world.add_soft(rope), AddResult::kAdded);
}

double fastest_within(SoftStage& stage, double seconds) {
    double fastest = 0.0;
    stage.run(seconds,
              [&] { fastest = std::max(fastest, stage.rigid(kWeight).linear_velocity.norm()); });
    return fastest;
}

TEST(SoftAnchors, WeightOnARopeComesToRest) {
    for (const double mass_kg : {0.05, 0.4, 7.0}) {
        for (const Eigen::Vector2d& at : {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.5, 1.3)}) {
            SoftStage stage;
            const Eigen::Vector3d top(at.x(), at.y(), 2.16);
            add_pendulum(stage, top, mass_kg, 0.0);
            stage.run(8.0);
            const double early = fastest_within(stage, 4.0);
            EXPECT_LT(early, mass_kg < 1.0 ? 0.03 : 0.15) << mass_kg << " kg at " << at.transpose();
            if (mass_kg > 1.0) {  // a rope of that strength lets it bounce for a while
                stage.run(8.0);
                EXPECT_LT(fastest_within(stage, 4.0), 0.5 * early) << mass_kg << " kg";
            }
            const Eigen::Vector3d below = stage.rigid(kWeight).world_from_object.translation - top;
            EXPECT_LT(below.head<2>().norm(), 0.02) << mass_kg << " kg";
            EXPECT_NEAR(-below.z(), kRopeM + 0.5 * kBallM, 0.02 + 0.005 * mass_kg)
                << mass_kg << " kg";
        }
    }
}

TEST(SoftAnchors, PendulumGainsNoAmplitude) {
    for (const double mass_kg : {0.05, 0.4, 7.0}) {
        for (const double slant_rad : {0.2, 0.52, 1.2}) {
            SoftStage stage;
            const Eigen::Vector3d top(0.3, -0.2, 2.4);
            add_pendulum(stage, top, mass_kg, slant_rad);
            // of both per mass of both: the end of a rope may be fast for a moment
            const auto energy = [&] {
                const RigidState ball = stage.rigid(kWeight);
                double sum = mass_kg * (9.81 * ball.world_from_object.translation.z() +
                                        0.5 * ball.linear_velocity.squaredNorm());
                const SoftState& rope = stage.soft();
                const double node_kg = kRopeKg / static_cast<double>(rope.positions.size());
                for (std::size_t i = 0; i < rope.positions.size(); ++i)
                    sum += node_kg *
                           (9.81 * rope.positions[i].z() + 0.5 * rope.velocities[i].squaredNorm());
                return sum / (mass_kg + kRopeKg);
            };
            const double start = energy();
            double most = start;
            stage.run(12.0, [&] { most = std::max(most, energy()); });
            EXPECT_LT(most - start, 0.4) << "4 cm; " << mass_kg << " kg, " << slant_rad;
            EXPECT_LT(energy(), start + 0.02) << mass_kg << " kg, " << slant_rad;
        }
    }
}

TEST(SoftAnchors, BarAtTheFootOfAClothComesToRest) {
    for (const double mass_kg : {0.1, 0.5, 3.0}) {
        SoftStage stage;
        SoftObject cloth = curtain_at({0.4, -0.3, 1.5});
        cloth.size_m = {0.6, 1.0, 0.01};
        cloth.mass_kg = 0.3;
        cloth.pins = {{PinPlace::kTop}, {.place = PinPlace::kBottom, .object_id = kWeight}};
        RigidObject bar{.id = kWeight, .shape = ObjectShape::kBox, .mass_kg = mass_kg};
        bar.size_m = {0.6, 0.03, 0.03};
        bar.world_from_object.translation = {0.4, -0.3, 1.5 - 0.5 - 0.015};
        ASSERT_EQ(stage.world.add(bar), AddResult::kAdded);
        ASSERT_EQ(stage.world.add_soft(cloth), AddResult::kAdded);
        stage.run(12.0);
        EXPECT_LT(fastest_within(stage, 4.0), 0.05) << mass_kg << " kg";
        EXPECT_NEAR(stage.rigid(kWeight).world_from_object.translation.z(), 0.98, 0.1)
            << mass_kg << " kg";
    }
}

// A barrier of two posts that can move.
TEST(SoftAnchors, RopeBetweenTwoPostsHoldsAndFollows) {
    SoftStage stage;
    const double reach_m = 0.6;  // of each post from the middle
    RigidObject post{.shape = ObjectShape::kCylinder, .size_m = {0.3, 0.3, 0.9}, .mass_kg = 8.0};
    for (const auto& [id, x] : {std::pair{kWeight, -reach_m}, {kWeight + 1, reach_m}}) {
        post.id = id;
        post.world_from_object.translation = {x, 0.0, 0.45};
        ASSERT_EQ(stage.world.add(post), AddResult::kAdded);
    }
    SoftObject rope = rope_at({0.0, 0.0, 0.88});
    rope.size_m = {1.4, 0.03, 2.0 * reach_m};
    rope.pins = {{.place = PinPlace::kLeft, .object_id = kWeight},
                 {.place = PinPlace::kRight, .object_id = kWeight + 1}};
    ASSERT_EQ(stage.world.add_soft(rope), AddResult::kAdded);
    // where an end should be: in the axis of its post, 2 cm below the top
    const auto distance_m = [&](std::uint32_t id) {
        const Eigen::Vector3d top =
            stage.rigid(id).world_from_object * Eigen::Vector3d(0.0, 0.0, 0.43);
        const auto& nodes = stage.soft().positions;
        return ((id == kWeight ? nodes.front() : nodes.back()).cast<double>() - top).norm();
    };
    const auto expect_stands = [&](std::uint32_t id) {
        EXPECT_LT(distance_m(id), 0.01) << id;
        const Eigen::Vector3d up =
            stage.rigid(id).world_from_object.rotation * Eigen::Vector3d::UnitZ();
        EXPECT_GT(up.z(), 0.999) << id;
    };
    stage.run(4.0);
    for (const std::uint32_t id : {kWeight, kWeight + 1}) {
        expect_stands(id);
        EXPECT_NEAR(std::abs(stage.rigid(id).world_from_object.translation.x()), reach_m, 0.02);
    }
    // somebody carries a post a little further: the other one holds the other end
    geometry::RigidTransform goal = stage.rigid(kWeight).world_from_object;
    goal.translation += Eigen::Vector3d(0.1, 0.3, 0.0);
    ASSERT_EQ(stage.world.hold("eve", kWeight, goal), HoldResult::kHeld);
    stage.run(2.0);
    ASSERT_TRUE(stage.world.let_go("eve", kWeight));
    stage.run(2.0);
    EXPECT_NEAR(stage.rigid(kWeight).world_from_object.translation.y(), 0.3, 0.02);
    for (const std::uint32_t id : {kWeight, kWeight + 1}) expect_stands(id);
    // without its post, an end falls; the other one stays tied
    ASSERT_TRUE(stage.world.remove(kWeight));
    stage.run(2.0);
    EXPECT_LT(stage.soft().positions.front().z(), 0.1F);
    expect_stands(kWeight + 1);
}

// As if somebody pulled the weight of a swing along and lost hold of it.
TEST(SoftAnchors, DoNotFlingAWeightOnARope) {
    SoftStage stage;
    add_pendulum(stage, {0, 0, 2.2}, 0.4, 0.0);
    stage.run(1.0);
    for (const double away_m : {0.6, 1.2}) {
        RigidState state = stage.rigid(kWeight);
        const Eigen::Vector3d shift(0.5 * away_m, 0.0, -0.5 * away_m);
        state.world_from_object.translation += shift;
        ASSERT_TRUE(stage.world.set_state(state));
        SoftState stretched = stage.soft();
        for (std::size_t i = 0; i < stretched.positions.size(); ++i) {
            const double share =
                static_cast<double>(i) / static_cast<double>(stretched.positions.size() - 1);
            stretched.positions[i] += (share * shift).cast<float>();
        }
        ASSERT_TRUE(stage.world.restore_soft(stretched));
        stage.run(1.0, [&] {
            ASSERT_LT(stage.rigid(kWeight).linear_velocity.norm(), 6.5) << away_m << " m";
        });
        stage.run(8.0);
        EXPECT_LT(stage.rigid(kWeight).linear_velocity.norm(), 0.8)
            << "the swing must have nearly ended";
    }
}

}  // namespace
}  // namespace atrium::physics
