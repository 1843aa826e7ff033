// Soft objects that touch each other.
#include "soft_stage.hpp"
#include "tests/support/shapes/winding_number.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace atrium::physics {
namespace {

constexpr std::uint32_t kCloth = 51;

WorldOptions weightless() {
    WorldOptions options;
    options.gravity.setZero();
    return options;
}

// A cloth that hangs in the plane x = 0.
SoftObject hanging_cloth() {
    SoftObject cloth = curtain_at({0, 0, 1.2});
    cloth.id = kCloth;
    cloth.size_m = {1.2, 1.6, 0.01};
    cloth.world_from_object.rotation =
        Eigen::AngleAxisd(std::numbers::pi / 2.0, Eigen::Vector3d::UnitZ());
    return cloth;
}

// A cloth that lies in the plane z = `height_m`, held at its corners.
SoftObject stretched_sheet(double height_m) {
    SoftObject sheet = curtain_at({0, 0, height_m});
    sheet.id = kCloth;
    sheet.size_m = {1.0, 1.0, 0.01};
    sheet.spacing_m = 0.05;
    sheet.pins = {{PinPlace::kCorners}};
    sheet.world_from_object.rotation =
        Eigen::AngleAxisd(std::numbers::pi / 2.0, Eigen::Vector3d::UnitX());
    return sheet;
}

geometry::TriangleMesh surface_of(SoftStage& stage, std::uint32_t id) {
    geometry::TriangleMesh mesh;
    for (const Eigen::Vector3f& p : stage.soft(id).positions)
        mesh.vertices.push_back(p.cast<double>());
    mesh.triangles = stage.world.soft_topology(id)->triangles;
    return mesh;
}

std::size_t num_inside(SoftStage& stage, std::uint32_t volume, std::uint32_t other) {
    const geometry::TriangleMesh surface = surface_of(stage, volume);
    const std::vector<Eigen::Vector3f> nodes = stage.soft(other).positions;
    return static_cast<std::size_t>(
        std::count_if(nodes.begin(), nodes.end(), [&](const Eigen::Vector3f& p) {
            return test::winding_number(surface, p.cast<double>()) > 0.5;
        }));
}

double least_distance_m(SoftStage& stage, std::uint32_t id, const Eigen::Vector3d& point) {
    double least_m = 1e9;
    for (const Eigen::Vector3f& p : stage.soft(id).positions)
        least_m = std::min(least_m, (p.cast<double>() - point).norm());
    return least_m;
}

class SoftBallThrown : public testing::TestWithParam<double> {};

TEST_P(SoftBallThrown, PushesAHangingClothWithoutPassingThrough) {
    SoftStage stage;
    ASSERT_EQ(stage.world.add_soft(hanging_cloth()), AddResult::kAdded);
    ASSERT_EQ(stage.world.add_soft(ball_at({-0.6, 0, 1.2})), AddResult::kAdded);
    stage.throw_soft(kSoft, {GetParam(), 0, 0.5});
    double furthest_m = 0.0;
    stage.run(0.7, [&] {
        // Nodes of the cloth are 8 cm apart. The cloth cannot pass the middle of the ball of radius
        // 17.5 cm unless a node comes nearer to it than this.
        ASSERT_GT(least_distance_m(stage, kCloth, stage.centre()), 0.07);
        for (const Eigen::Vector3f& p : stage.soft(kCloth).positions)
            furthest_m = std::max<double>(furthest_m, p.x());
    });
    EXPECT_GT(furthest_m, 0.1);
    EXPECT_EQ(num_inside(stage, kSoft, kCloth), 0U);
    EXPECT_LT(stage.soft(kSoft).velocities[0].x(), 0.7 * GetParam())
        << "the cloth must slow the ball down";
    EXPECT_EQ(stage.world.counters().num_torn, 0U);
}
INSTANTIATE_TEST_SUITE_P(Speeds, SoftBallThrown, testing::Values(2.0, 4.0, 8.0));

TEST(SoftSoftContacts, ConserveMomentum) {
    SoftStage stage(weightless());
    SoftObject left = ball_at({-0.3, 0, 1});
    SoftObject right = ball_at({0.3, 0.05, 1});
    right.id = 51;
    right.mass_kg = 1.0;
    left.damping_hz = right.damping_hz = 0.0;
    ASSERT_EQ(stage.world.add_soft(left), AddResult::kAdded);
    ASSERT_EQ(stage.world.add_soft(right), AddResult::kAdded);
    stage.throw_soft(left.id, {2, 0, 0});
    double least_m = 1e9;
    stage.run(1.0, [&] {
        least_m = std::min(least_m, (stage.centre(50) - stage.centre(51)).norm());
        // nothing else can push them
        EXPECT_NEAR(stage.momentum(left).x() + stage.momentum(right).x(), 1.0, 0.01);
    });
    EXPECT_GT(least_m, 0.25) << "the balls have a diameter of 0.35 m";
    EXPECT_GT(stage.momentum(right).x(), 0.5);
    EXPECT_LT(stage.momentum(right).x(), 1.35)
        << "they must not separate faster than they approached";
    EXPECT_EQ(num_inside(stage, 50, 51) + num_inside(stage, 51, 50), 0U);
}

TEST(SoftSoftContacts, SheetCarriesASoftBall) {
    SoftStage stage;
    ASSERT_EQ(stage.world.add_soft(stretched_sheet(1.0)), AddResult::kAdded);
    ASSERT_EQ(stage.world.add_soft(ball_at({0.03, 0.02, 1.4})), AddResult::kAdded);
    stage.run(5.0, [&] { ASSERT_GT(stage.centre().z(), 0.5); });
    EXPECT_GT(stage.lowest_m() - stage.lowest_m(kCloth), -0.01) << "the ball must lie in the sheet";
    EXPECT_EQ(num_inside(stage, kSoft, kCloth), 0U);
    EXPECT_LT(stage.mean_square_speed(), 0.1 * 0.1);
}

TEST(SoftSoftContacts, ClothDrapesOverASoftBox) {
    SoftStage stage;
    SoftObject box = ball_at({0, 0, 0.15});
    box.shape = SoftShape::kBox;
    box.size_m = {0.4, 0.4, 0.3};
    box.stiffness = 0.8;
    SoftObject sheet = stretched_sheet(0.5);
    sheet.pins.clear();
    ASSERT_EQ(stage.world.add_soft(box), AddResult::kAdded);
    ASSERT_EQ(stage.world.add_soft(sheet), AddResult::kAdded);
    stage.run(3.0);
    EXPECT_EQ(num_inside(stage, kSoft, kCloth), 0U);
    double highest_m = 0.0;
    for (const Eigen::Vector3f& p : stage.soft(kCloth).positions)
        highest_m = std::max<double>(highest_m, p.z());
    EXPECT_GT(highest_m, 0.25) << "the cloth must lie on the box";
    EXPECT_LT(stage.lowest_m(kCloth), 0.15) << "the cloth must hang down at the sides";
    EXPECT_LT(stage.mean_square_speed(kCloth), 0.1 * 0.1);
}

TEST(SoftSoftContacts, RopeLiesOnASheet) {
    SoftStage stage;
    SoftObject rope = rope_at({0, 0, 1.5});
    rope.size_m = {0.6, 0.02, 0.6};
    rope.pins.clear();
    ASSERT_EQ(stage.world.add_soft(stretched_sheet(1.0)), AddResult::kAdded);
    ASSERT_EQ(stage.world.add_soft(rope), AddResult::kAdded);
    stage.run(3.0);
    EXPECT_GT(stage.centre().z(), 0.7);
    EXPECT_LT(stage.centre().z(), 1.0);
}

// A ball that moves into a curtain.
void begin_contact(SoftStage& stage) {
    ASSERT_EQ(stage.world.add_soft(hanging_cloth()), AddResult::kAdded);
    ASSERT_EQ(stage.world.add_soft(ball_at({-0.6, 0.1, 1.2})), AddResult::kAdded);
    stage.throw_soft(kSoft, {4, 0, 0.5});
}

TEST(SoftSoftContacts, AreRepeatable) {
    const auto hashes = [] {
        SoftStage stage;
        begin_contact(stage);
        std::vector<std::uint64_t> all;
        stage.run(1.0, [&] { all.push_back(stage.world.state_hash()); });
        return all;
    };
    EXPECT_EQ(hashes(), hashes());
}

TEST(SoftSoftContacts, ContinueFromAStateSavedDuringATouch) {
    SoftStage once;
    begin_contact(once);
    once.run(0.15);
    ASSERT_LT(least_distance_m(once, kCloth, once.centre()), 0.19) << "they must touch";
    WorldState saved;
    once.world.get_state(saved);
    ASSERT_TRUE(once.world.set_state(saved));
    SoftStage again;
    begin_contact(again);
    ASSERT_TRUE(again.world.set_state(saved));
    for (int i = 0; i < 60; ++i) {
        once.run(kTickS);
        again.run(kTickS);
        ASSERT_EQ(once.world.state_hash(), again.world.state_hash()) << i;
    }
}

}  // namespace
}  // namespace atrium::physics
