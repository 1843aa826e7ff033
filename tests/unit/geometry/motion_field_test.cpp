#include "core/geometry/motion_field.hpp"

#include "tests/support/random.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace atrium::geometry {
namespace {

using Eigen::Vector3f;

constexpr float kCell_m = 0.1F;

// Cells of a wall of one square metre that moves as `motion_at` says.
template <typename MotionAt>
std::vector<MotionCell> wall(const MotionAt& motion_at) {
    std::vector<MotionCell> cells;
    for (int row = 0; row < 10; ++row) {
        for (int column = 0; column < 10; ++column) {
            MotionCell& cell = cells.emplace_back();
            cell.centre =
                kCell_m * Vector3f(static_cast<float>(column), 0.0F, static_cast<float>(row));
            motion_at(cell);
        }
    }
    return cells;
}

TEST(MotionField, ReproducesARigidMotionBetweenTheCentres) {
    const Vector3f velocity(0.4F, -1.0F, 0.3F);
    const Vector3f turn(1.0F, 2.0F, -0.5F);
    MotionField field;
    field.assign(wall([&](MotionCell& cell) {
                     cell.velocity = velocity + turn.cross(cell.centre);
                     cell.turn = turn;
                     cell.confidence = 1.0F;
                 }),
                 kCell_m);
    test::Random random(1);
    for (int i = 0; i < 200; ++i) {
        const Vector3f place =
            test::between(random, {0.0, -0.05, 0.0}, {0.9, 0.05, 0.9}).cast<float>();
        const FoundMotion found = field.at(place);
        EXPECT_LT((found.velocity - velocity - turn.cross(place)).norm(), 1e-4F);
        EXPECT_NEAR(found.confidence, 1.0F, 1e-4F);
    }
}

TEST(MotionField, PartsThatMoveDifferentlyDoNotBlend) {
    MotionField field;
    field.assign(wall([](MotionCell& cell) {
                     cell.velocity = {cell.centre.x() < 0.45F ? 0.0F : 6.0F, 0.0F, 0.0F};
                     cell.confidence = 1.0F;
                 }),
                 kCell_m);
    EXPECT_LT(field.at({0.4F, 0.0F, 0.5F}).velocity.norm(), 0.1F);
    EXPECT_NEAR(field.at({0.5F, 0.0F, 0.5F}).velocity.x(), 6.0F, 0.1F);
}

TEST(MotionField, KnowsNothingFarFromItsCells) {
    MotionField field;
    EXPECT_EQ(field.at({0.0F, 0.0F, 0.0F}).confidence, 0.0F);
    field.assign(wall([](MotionCell& cell) { cell.confidence = 1.0F; }), kCell_m);
    EXPECT_EQ(field.at({0.5F, 0.21F, 0.5F}).confidence, 0.0F);
    EXPECT_EQ(field.at({0.5F, 0.0F, 1.5F}).confidence, 0.0F);
    EXPECT_GT(field.at({0.5F, 0.1F, 0.5F}).confidence, 0.9F);
}

}  // namespace
}  // namespace atrium::geometry
