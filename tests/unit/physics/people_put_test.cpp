// Objects that a reset puts into people.
#include "soft_stage.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace atrium::physics {
namespace {

using physics_test::make_box_mesh;

constexpr std::uint32_t kBall = 2;
const Eigen::Vector3d kStart(0.0, 0.0, 0.06);

// A hand whose fingertips are at `tip_x`, as high as the middle of the ball, and its person.
geometry::TriangleMesh hand_at(double tip_x) {
    const auto at = [](double x, double z) {
        return geometry::RigidTransform{Eigen::Quaterniond::Identity(), {x, 0.0, z}};
    };
    geometry::TriangleMesh mesh = make_box_mesh({0.5, 0.08, 0.03}, at(tip_x - 0.25, 0.06), 10);
    geometry::append(mesh, make_box_mesh({0.3, 0.4, 1.7}, at(-1.5, 0.85), 10));
    return mesh;
}

class PutOntoAHand : public testing::Test {
protected:
    void SetUp() override {
        RigidObject ball{.id = kBall, .shape = ObjectShape::kSphere, .mass_kg = 0.4};
        ball.size_m = Eigen::Vector3d::Constant(0.12);
        ball.world_from_object.translation = kStart;
        ASSERT_EQ(stage_.world.add(ball), AddResult::kAdded);
        // the ball is elsewhere when somebody reaches to its start
        RigidState away = stage_.rigid(kBall);
        away.world_from_object.translation.y() = 2.0;
        ASSERT_TRUE(stage_.world.set_state(away));
        stage_.play(0.4, [](double) { return hand_at(-0.015); });
        stage_.world.reset();
    }
    double off_m() { return (stage_.rigid(kBall).world_from_object.translation - kStart).norm(); }

    SoftStage stage_;
};

TEST_F(PutOntoAHand, ObjectStaysUntouchedWhileTheHandIsInIt) {
    double furthest = 0.0;
    const auto look = [&](double) { furthest = std::max(furthest, off_m()); };
    const auto still = [](double) { return hand_at(-0.015); };
    stage_.play(1.0, still, look);
    EXPECT_LT(furthest, 0.001);
}

TEST_F(PutOntoAHand, ObjectIsTouchedAgainAfterTheHandHasLeft) {
    const auto still = [](double) { return hand_at(-0.015); };
    const auto push = [](double t) { return hand_at(-0.32 + 0.4 * t); };
    stage_.play(0.2, still);
    stage_.world.remove_person("anna");
    stage_.run(0.1);
    stage_.play(1.5, push);
    EXPECT_GT(stage_.rigid(kBall).world_from_object.translation.x(), 0.25);
}

}  // namespace
}  // namespace atrium::physics
