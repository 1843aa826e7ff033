// Cloth that starts flat.
#include "soft_stage.hpp"
#include "tests/support/sanitized.hpp"

#include <gtest/gtest.h>

#include <cmath>
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

}  // namespace
}  // namespace atrium::physics
