// Cloth that starts flat, or hanging.
#include "soft_stage.hpp"
#include "tests/support/sanitized.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace atrium::physics {
namespace {

SoftObject flag(const Eigen::Vector2d& size_m, double stiffness) {
    SoftObject cloth;
    cloth.id = kSoft;
    cloth.size_m = {size_m.x(), size_m.y(), 0.01};
    cloth.mass_kg = 0.15;
    cloth.stiffness = stiffness;
    cloth.pins = {{PinPlace::kLeft}};
    cloth.world_from_object.translation = {0.0, 0.0, 1.8};
    return cloth;
}

// How far the middle of the cloth's free edge is below the middle of the pinned one.
double droop_m(const std::vector<Eigen::Vector3f>& nodes, const SoftObject& cloth) {
    const auto columns =
        static_cast<std::size_t>(std::lround(cloth.size_m.x() / cloth.spacing_m)) + 1;
    const std::size_t rows = nodes.size() / columns;
    double droop = 0.0;
    for (std::size_t z = 0; z < rows; ++z)
        droop += nodes[z * columns].z() - nodes[(z + 1) * columns - 1].z();
    return droop / static_cast<double>(rows);
}

// Nothing pushes it out of its plane, in which it holds itself like a board.
TEST(SoftCloth, HangsDownFromAPoleThatHoldsItsSide) {
    for (const double stiffness : {0.0, 0.3, 0.5}) {
        for (const Eigen::Vector2d& size_m : {Eigen::Vector2d(0.8, 0.5), {1.2, 0.25}}) {
            if (test::kSanitized && stiffness != 0.3) continue;
            const SoftObject cloth = flag(size_m, stiffness);
            SoftStage stage;
            ASSERT_EQ(stage.world.add_soft(cloth), AddResult::kAdded);
            EXPECT_LT(std::abs(droop_m(stage.soft().positions, cloth)), 0.001);
            stage.run(8.0);
            EXPECT_GT(droop_m(stage.soft().positions, cloth), 0.6 * size_m.x())
                << stiffness << ", " << size_m.transpose();
        }
    }
}

TEST(SoftCloth, StartsFlatToAFifthOfAMillimetre) {
    const SoftObject cloth = flag({0.8, 0.5}, 0.3);
    SoftStage stage;
    ASSERT_EQ(stage.world.add_soft(cloth), AddResult::kAdded);
    for (const Eigen::Vector3f& node : stage.soft().positions) {
        EXPECT_LE(std::abs(node.x()), 0.4F + 1e-6F);
        EXPECT_LE(std::abs(node.y()), 0.0002F + 1e-6F);
        EXPECT_LE(std::abs(node.z() - 1.8F), 0.25F + 1e-6F);
    }
}

// Glasses on a foot that is little wider than the distance of the cloth's nodes.
TEST(SoftCloth, CarriesGlassesOnATable) {
    SoftStage stage;
    RigidObject top;
    top.id = 7;
    top.shape = ObjectShape::kBox;
    top.size_m = {1.2, 0.7, 0.04};
    top.mass_kg = 0.0;
    top.world_from_object.translation = {0, 0, 0.72};
    ASSERT_EQ(stage.world.add(top), AddResult::kAdded);
    SoftObject cloth;  // hangs over on all sides
    cloth.id = kSoft;
    cloth.size_m = {1.6, 1.1, 0.01};
    cloth.mass_kg = 0.4;
    cloth.damping_hz = 1.5;
    cloth.world_from_object = {
        Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2.0, Eigen::Vector3d::UnitX())),
        Eigen::Vector3d(0, 0, 0.75)};
    ASSERT_EQ(stage.world.add_soft(cloth), AddResult::kAdded);
    constexpr std::uint32_t kFirst = 20;
    std::vector<Eigen::Vector3d> places;
    for (const double x : {-0.38, 0.0, 0.38})
        for (const double y : {-0.17, 0.17}) places.emplace_back(x, y, 0.755 + 0.065 + 0.001);
    for (std::uint32_t i = 0; i < places.size(); ++i) {
        RigidObject glass;
        glass.id = kFirst + i;
        glass.shape = ObjectShape::kCylinder;
        glass.size_m = {0.07, 0.07, 0.13};
        glass.mass_kg = 0.25;
        glass.world_from_object.translation = places[i];
        ASSERT_EQ(stage.world.add(glass), AddResult::kAdded);
    }
    stage.run(test::kSanitized ? 5.0 : 20.0);
    for (std::uint32_t i = 0; i < places.size(); ++i) {
        const geometry::RigidTransform pose = stage.rigid(kFirst + i).world_from_object;
        const Eigen::Vector3d up = pose.rotation * Eigen::Vector3d::UnitZ();
        EXPECT_LT(std::acos(std::min(1.0, up.z())), 0.05) << i;
        EXPECT_LT((pose.translation - places[i]).norm(), 0.03)
            << i << ": as far as the cloth settles";
    }
}

// Lies between two bars at x = +-0.8, 1 m above the floor.
SoftObject hammock(double span_m) {
    SoftObject cloth;
    cloth.id = kSoft;
    cloth.size_m = {2.0, 1.0, 0.01};
    cloth.span_m = span_m;
    cloth.spacing_m = 0.08;
    cloth.mass_kg = 0.6;
    cloth.damping_hz = 1.5;
    cloth.pins = {{PinPlace::kLeft}, {PinPlace::kRight}};
    cloth.world_from_object = {
        Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2.0, Eigen::Vector3d::UnitX())),
        Eigen::Vector3d(0, 0, 1.0)};
    return cloth;
}

TEST(SoftCloth, StartsHangingBetweenItsEdges) {
    const SoftObject cloth = hammock(1.6);
    SoftStage stage;
    ASSERT_EQ(stage.world.add_soft(cloth), AddResult::kAdded);
    const std::vector<Eigen::Vector3f> nodes = stage.soft().positions;
    constexpr std::size_t kColumns = 26;
    ASSERT_EQ(nodes.size() % kColumns, 0U);
    double low_m = 1.0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        low_m = std::min<double>(low_m, nodes[i].z());
        if (i % kColumns == 0) {
            EXPECT_NEAR(nodes[i].x(), -0.8F, 1e-5F);
        }
        if (i % kColumns != kColumns - 1) {
            const double part_m = (nodes[i + 1] - nodes[i]).norm();
            EXPECT_NEAR(part_m, 2.0 / (kColumns - 1), 0.003) << "neither stretched nor slack";
        } else {
            EXPECT_NEAR(nodes[i].x(), 0.8F, 1e-5F);
        }
        EXPECT_NEAR(nodes[i].z(), nodes[i % kColumns].z(), 0.0005F) << "all along its height";
    }
    // half a parabola with this slope at its end
    const double slope = 4.0 * (1.0 - low_m) / 1.6;
    const double length_m = 0.8 * (std::sqrt(1.0 + slope * slope) + std::asinh(slope) / slope);
    EXPECT_NEAR(length_m, 2.0, 0.02);

    std::vector<Eigen::Vector3f> after;
    stage.run(10.0, [&] { after = stage.soft().positions; });
    for (std::size_t i = 0; i < nodes.size(); ++i)
        EXPECT_LT((after[i] - nodes[i]).norm(), 0.06F) << "it starts near to where it hangs";
}

TEST(SoftCloth, HoldsABallAndABoxInAHammock) {
    for (const bool is_ball : {true, false}) {
        if (test::kSanitized && !is_ball) continue;
        SoftStage stage;
        ASSERT_EQ(stage.world.add_soft(hammock(1.7)), AddResult::kAdded);
        RigidObject thing;
        thing.id = 7;
        thing.shape = is_ball ? ObjectShape::kSphere : ObjectShape::kBox;
        thing.size_m.setConstant(0.2);
        thing.mass_kg = 0.5;
        thing.world_from_object.translation = {0.1, 0.05, 0.95};
        ASSERT_EQ(stage.world.add(thing), AddResult::kAdded);
        stage.run(20.0);
        const Eigen::Vector3d place = stage.rigid(7).world_from_object.translation;
        EXPECT_GT(place.z(), 0.35) << "in the cloth, not on the floor";
        EXPECT_LT(std::abs(place.x()), 0.4);
        EXPECT_LT(std::abs(place.y()), 0.4);
    }
}

TEST(SoftCloth, RefusesASpanWiderThanItself) {
    SoftObject cloth = hammock(1.6);
    EXPECT_FALSE(find_problem(cloth));
    for (const double span_m : {0.0, -1.0, 2.1, std::nan("")}) {
        cloth.span_m = span_m;
        ASSERT_TRUE(find_problem(cloth)) << span_m;
        EXPECT_EQ(find_problem(cloth)->field, "span_m");
    }
    SoftObject ball = ball_at({0, 0, 1});
    ball.span_m = 0.2;
    ASSERT_TRUE(find_problem(ball));
    EXPECT_EQ(find_problem(ball)->field, "span_m");
}

}  // namespace
}  // namespace atrium::physics
