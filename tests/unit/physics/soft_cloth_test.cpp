// Cloth that starts flat.
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

}  // namespace
}  // namespace atrium::physics
