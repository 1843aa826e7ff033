// Soft objects on the floor, on pins and among rigid objects.
#include "soft_stage.hpp"
#include "tests/support/sanitized.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

namespace atrium::physics {
namespace {

using physics_test::make_box_mesh;
using physics_test::make_person_mesh;

TEST(SoftObject, IsRefusedWithAReason) {
    EXPECT_FALSE(find_problem(ball_at({0, 0, 1})).has_value());
    EXPECT_FALSE(find_problem(curtain_at({0, 0, 1})).has_value());
    EXPECT_FALSE(find_problem(rope_at({0, 0, 1})).has_value());
    SoftObject fine = curtain_at({0, 0, 1});
    fine.spacing_m = 0.02;
    EXPECT_EQ(find_problem(fine)->field, "spacing_m");
    SoftObject nothing = ball_at({0, 0, 1});
    nothing.mass_kg = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(find_problem(nothing)->field, "mass_kg");
    SoftObject taut = rope_at({0, 0, 1});
    taut.size_m.z() = 2.5;
    EXPECT_EQ(find_problem(taut)->field, "span_m");
    SoftObject pinned = ball_at({0, 0, 1});
    pinned.pins = {{PinPlace::kTop}};
    EXPECT_EQ(find_problem(pinned)->field, "pins");
    SoftObject open = ball_at({0, 0, 1});
    open.shape = SoftShape::kModel;
    open.model = make_box_mesh({0.3, 0.3, 0.3}, {}, 2);
    open.model.triangles.pop_back();
    EXPECT_EQ(find_problem(open)->field, "model");
}

TEST(SoftObject, SharesIdsAndNodeLimitWithOthers) {
    SoftStage stage;
    SoftObject ball = ball_at({0, 0, 1});
    ball.id = 1;
    EXPECT_EQ(stage.world.add_soft(ball), AddResult::kIdInUse);
    ball.spacing_m = 0.018;  // about 1200 nodes
    for (ball.id = 2; ball.id < 5; ++ball.id) {
        ASSERT_EQ(stage.world.add_soft(ball), AddResult::kAdded);
    }
    EXPECT_EQ(stage.world.add_soft(ball), AddResult::kWorldFull);
    EXPECT_TRUE(stage.world.remove(2));
    EXPECT_FALSE(stage.world.remove(2));
    EXPECT_EQ(stage.world.add_soft(ball), AddResult::kAdded);
}

TEST(SoftBall, RestsOnTheFloorAndKeepsItsVolume) {
    SoftStage stage;
    ASSERT_EQ(stage.world.add_soft(ball_at({0, 0, 0.5})), AddResult::kAdded);
    const double volume = stage.volume_m3();
    double worst = 0.0;
    stage.run(5.0, [&] {
        worst = std::max(worst, std::abs(stage.volume_m3() / volume - 1.0));
        ASSERT_GT(stage.lowest_m(), -0.002);
    });
    EXPECT_LT(worst, 0.05);
    const Eigen::Vector3d before = stage.centre();
    EXPECT_GT(before.z(), 0.09);  // it sags, but stays a ball
    EXPECT_LT(before.z(), 0.18);
    stage.run(5.0);
    EXPECT_LT((stage.centre() - before).norm(), 0.02);
    EXPECT_LT(stage.mean_square_speed(), 0.02 * 0.02);
}

TEST(SoftBox, KeepsItsShape) {
    SoftStage stage;
    SoftObject box = ball_at({0, 0, 0.4});
    box.shape = SoftShape::kBox;
    box.size_m = {0.3, 0.3, 0.2};
    box.stiffness = 0.8;
    ASSERT_EQ(stage.world.add_soft(box), AddResult::kAdded);
    const double volume = stage.volume_m3();
    stage.run(4.0);
    EXPECT_NEAR(stage.volume_m3() / volume, 1.0, 0.05);
    EXPECT_NEAR(stage.centre().z(), 0.1, 0.03);
}

TEST(SoftModel, CanBeAnyClosedMesh) {
    SoftStage stage;
    SoftObject model = ball_at({0, 0, 0.4});
    model.shape = SoftShape::kModel;
    model.model = make_box_mesh({0.3, 0.2, 0.2}, {}, 4);
    ASSERT_TRUE(geometry::inspect(model.model).manifold);
    ASSERT_EQ(stage.world.add_soft(model), AddResult::kAdded);
    const double volume = stage.volume_m3();
    stage.run(3.0);
    EXPECT_NEAR(stage.volume_m3() / volume, 1.0, 0.05);
    EXPECT_GT(stage.lowest_m(), -0.002);
}

TEST(SoftCloth, HangsFromItsPins) {
    SoftStage stage;
    ASSERT_EQ(stage.world.add_soft(curtain_at({0, 0, 1.1})), AddResult::kAdded);
    const std::vector<Eigen::Vector3f> start = stage.soft().positions;
    stage.run(5.0);
    const SoftState& state = stage.soft();
    double lowest = 1e9;
    for (std::size_t i = 0; i < start.size(); ++i) {
        if (start[i].z() > 2.0499F) {
            EXPECT_EQ(state.positions[i], start[i]);
        }
        lowest = std::min<double>(lowest, state.positions[i].z());
    }
    EXPECT_NEAR(lowest, 0.15, 0.02 * 1.9);  // stretched by at most 2 %
    EXPECT_LT(stage.fastest_mps(), 0.05);
}

TEST(SoftRope, HangsByItsEndsAndKeepsItsLength) {
    SoftStage stage;
    ASSERT_EQ(stage.world.add_soft(rope_at({0, 0, 2})), AddResult::kAdded);
    const std::vector<Eigen::Vector3f> start = stage.soft().positions;
    stage.run(8.0);
    const SoftState& state = stage.soft();
    EXPECT_EQ(state.positions.front(), start.front());
    EXPECT_EQ(state.positions.back(), start.back());
    EXPECT_NEAR(stage.rope_length_m(), 2.0, 0.02 * 2.0);
    // a catenary of 2 m between ends 1.2 m apart sags by 0.733 m
    EXPECT_NEAR(2.0 - stage.lowest_m(), 0.733, 0.05);
}

TEST(SoftRope, CarriesATiedObject) {
    SoftStage stage;
    ASSERT_EQ(stage.world.add({.id = 7,
                               .size_m = {0.1, 0.1, 0.1},
                               .mass_kg = 0.3,
                               .world_from_object = {Eigen::Quaterniond::Identity(), {0.5, 0, 2}}}),
              AddResult::kAdded);
    SoftObject rope = rope_at({0, 0, 2});
    rope.size_m = {1.0, 0.02, 1.0};
    rope.mass_kg = 0.3;
    rope.pins = {{PinPlace::kLeft}, {.place = PinPlace::kRight, .object_id = 7}};
    ASSERT_EQ(stage.world.add_soft(rope), AddResult::kAdded);
    double longest = 0.0;
    stage.run(6.0, [&] {
        const Eigen::Vector3d end = stage.rigid(7).world_from_object.translation;
        longest = std::max(longest, (end - Eigen::Vector3d(-0.5, 0, 2)).norm());
    });
    EXPECT_LT(longest, 1.12);  // the box swings on the rope, which hardly stretches
    EXPECT_LT(stage.rigid(7).world_from_object.translation.z(), 1.9);
    rope.id = 51;
    rope.pins = {{.place = PinPlace::kRight, .object_id = 99}};
    EXPECT_EQ(stage.world.add_soft(rope), AddResult::kInvalid);
    ASSERT_TRUE(stage.world.remove(7));
    stage.run(0.5);  // the box no longer affects the rope
    EXPECT_LT(stage.fastest_mps(), 15.1);
}

// A square of 2 m in the plane z = height_m, with this many triangles.
geometry::TriangleMesh terrain(double height_m, int num_cuts) {
    geometry::TriangleMesh mesh;
    const auto across = static_cast<std::uint32_t>(num_cuts + 1);
    for (std::uint32_t i = 0; i < across; ++i) {
        for (std::uint32_t j = 0; j < across; ++j) {
            mesh.vertices.emplace_back(
                2.0 * i / num_cuts - 1.0, 2.0 * j / num_cuts - 1.0, height_m);
            if (i + 1 == across || j + 1 == across) continue;
            const std::uint32_t a = i * across + j;
            mesh.triangles.push_back({a, a + across, a + across + 1});
            mesh.triangles.push_back({a, a + across + 1, a + 1});
        }
    }
    return mesh;
}

TEST(SoftWorld, RestsOnSolidScenery) {
    for (const int num_cuts : {1, 20}) {
        SoftStage stage;
        ASSERT_TRUE(stage.world.add_static({.mesh = terrain(0.5, num_cuts)}));
        ASSERT_EQ(stage.world.add_soft(ball_at({-0.4, 0.1, 1.2})), AddResult::kAdded);
        SoftObject sheet = curtain_at({0.4, 0, 0.9});
        sheet.id = 51;
        sheet.size_m = {0.5, 0.5, 0.01};
        sheet.pins.clear();
        sheet.world_from_object.rotation =
            Eigen::AngleAxisd(std::numbers::pi / 2.0, Eigen::Vector3d::UnitX());
        ASSERT_EQ(stage.world.add_soft(sheet), AddResult::kAdded);
        stage.run(3.0, [&] {
            ASSERT_GT(stage.lowest_m(), 0.498) << num_cuts;
            ASSERT_GT(stage.lowest_m(51), 0.498) << num_cuts;
        });
        EXPECT_LT(stage.centre().z(), 0.7);
        EXPECT_NEAR(stage.centre(51).z(), 0.505, 0.005)
            << "the cloth must lie half of its thickness above the table";
        stage.run(7.0);  // the time that a ball on a plane needs to come to rest
        EXPECT_LT(stage.mean_square_speed(), 0.02 * 0.02);
    }
}

TEST(SoftWorld, StaysInsideTheWallsOfItsBounds) {
    WorldOptions options;
    options.box = geometry::Aabb{.min = {-1, -1, -1}, .max = {1, 1, 3}};
    options.leaving = LeavePolicy::kBounce;
    SoftStage stage(options);
    ASSERT_EQ(stage.world.add_soft(ball_at({0, 0, 0.3})), AddResult::kAdded);
    stage.throw_soft(kSoft, {6, 0, 1});
    double furthest_m = 0.0;
    stage.run(2.0, [&] {
        for (const Eigen::Vector3f& p : stage.soft().positions)
            furthest_m = std::max<double>(furthest_m, p.x());
    });
    EXPECT_GT(furthest_m, 0.98) << "the ball must reach the wall";
    EXPECT_LT(furthest_m, 1.01);
    EXPECT_EQ(stage.world.counters().num_strays, 0U);
}

TEST(SoftWorld, IsRepeatable) {
    const auto hashes = [] {
        SoftStage stage;
        EXPECT_EQ(stage.world.add_soft(ball_at({0.05, 0, 0.6})), AddResult::kAdded);
        SoftObject cloth = curtain_at({0.4, 0, 1.1});
        cloth.id = 51;
        EXPECT_EQ(stage.world.add_soft(cloth), AddResult::kAdded);
        EXPECT_EQ(
            stage.world.add({.id = 7,
                             .size_m = {0.2, 0.2, 0.2},
                             .mass_kg = 1.0,
                             .world_from_object = {Eigen::Quaterniond::Identity(), {0, 0, 1.2}}}),
            AddResult::kAdded);
        std::vector<std::uint64_t> all;
        stage.play(
            1.5,
            [](double t) {
                return make_person_mesh({-0.8 + 0.6 * t, 0, 0}, 0.4, 12);
            },
            [&](double) { all.push_back(stage.world.state_hash()); });
        return all;
    };
    EXPECT_EQ(hashes(), hashes());
}

TEST(SoftWorld, ContinuesIdenticallyFromASavedState) {
    SoftStage once;
    ASSERT_EQ(once.world.add_soft(ball_at({0, 0, 0.6})), AddResult::kAdded);
    once.run(0.5);
    const SoftState saved = once.soft();
    SoftStage again;
    ASSERT_EQ(again.world.add_soft(ball_at({0, 0, 0.6})), AddResult::kAdded);
    ASSERT_TRUE(again.world.restore_soft(saved));
    once.run(0.5);
    again.run(0.5);
    EXPECT_EQ(once.world.state_hash(), again.world.state_hash());

    SoftState broken = saved;
    broken.positions.pop_back();
    EXPECT_FALSE(again.world.restore_soft(broken));
    broken = saved;
    broken.velocities[3].x() = std::numeric_limits<float>::infinity();
    EXPECT_FALSE(again.world.restore_soft(broken));
    EXPECT_EQ(once.world.state_hash(), again.world.state_hash());
}

TEST(SoftWorld, LimitsTheSpeedOfNodes) {
    for (const auto& object : {curtain_at({0, 0, 1.5}), ball_at({0, 0, 1.0}), rope_at({0, 0, 1})}) {
        SoftStage stage({.max_speed_mps = 4.0});
        ASSERT_EQ(stage.world.add_soft(object), AddResult::kAdded);
        std::mt19937 random(8);
        std::uniform_real_distribution<float> speed(-6.0F, 6.0F);
        for (int round = 0; round < 20; ++round) {
            SoftState torn_at = stage.soft();
            for (Eigen::Vector3f& v : torn_at.velocities)
                v = {speed(random), speed(random), speed(random)};
            ASSERT_TRUE(stage.world.restore_soft(torn_at));
            stage.run(0.05, [&] {
                for (const Eigen::Vector3f& v : stage.soft().velocities)
                    ASSERT_LE(v.norm(), 4.0F * 1.0001F);
            });
        }
    }
}

// As if somebody pulled part of it away and lost hold of it.
TEST(SoftWorld, SnapsBackWithoutBeingFlung) {
    const auto rope = rope_at({0, 0, 1.5});
    const auto curtain = curtain_at({0, 0, 2.0});
    // pulled to twice the distance below the pins, or partly torn off the rest
    const auto doubled = [](float below_m) { return 2.0F * below_m; };
    const auto torn = [](float below_m) { return below_m > 0.4F ? below_m + 0.6F : below_m; };
    for (const auto& object : {rope, curtain}) {
        for (const std::function<float(float)>& pulled :
             std::initializer_list<std::function<float(float)>>{doubled, torn}) {
            SoftStage stage;
            ASSERT_EQ(stage.world.add_soft(object), AddResult::kAdded);
            stage.run(2.0);
            SoftState state = stage.soft();
            const std::vector<Eigen::Vector3f> hanging = state.positions;
            float top_m = 0.0F;
            for (const Eigen::Vector3f& x : hanging) top_m = std::max(top_m, x.z());
            for (Eigen::Vector3f& x : state.positions) x.z() = top_m - pulled(top_m - x.z());
            ASSERT_TRUE(stage.world.restore_soft(state));
            const auto num_nodes = static_cast<double>(hanging.size());
            stage.run(0.5, [&] {
                double sum = 0.0;
                for (const Eigen::Vector3f& v : stage.soft().velocities) sum += v.squaredNorm();
                ASSERT_LT(std::sqrt(sum / num_nodes), 5.0);
            });
            stage.run(8.0);
            double off_m = 0.0;
            for (std::size_t i = 0; i < hanging.size(); ++i)
                off_m += (stage.soft().positions[i] - hanging[i]).cast<double>().norm() / num_nodes;
            EXPECT_LT(off_m, 0.15) << "the object must hang again";
        }
    }
}

TEST(SoftWorld, ResetsObjectsThatLeaveIt) {
    SoftStage stage;
    ASSERT_EQ(stage.world.add_soft(ball_at({0, 0, 0.6})), AddResult::kAdded);
    SoftState far = stage.soft();
    for (Eigen::Vector3f& p : far.positions) p.x() += 100.0F;
    ASSERT_TRUE(stage.world.restore_soft(far));
    stage.run(kTickS);
    EXPECT_EQ(stage.world.counters().num_strays, 1U);
    EXPECT_NEAR(stage.centre().x(), 0.0, 1e-3);
}

TEST(SoftWorld, RemovesObjectsThatLeaveItIfItsBoundsSaySo) {
    SoftStage stage({.leaving = LeavePolicy::kRemove});
    ASSERT_EQ(stage.world.add_soft(ball_at({0, 0, 0.6})), AddResult::kAdded);
    SoftState far = stage.soft();
    for (Eigen::Vector3f& p : far.positions) p.x() += 100.0F;
    ASSERT_TRUE(stage.world.restore_soft(far));
    stage.run(kTickS);
    std::vector<Incident> incidents;
    stage.world.take_incidents(incidents);
    ASSERT_EQ(incidents.size(), 1U);
    EXPECT_EQ(incidents[0].object, kSoft);
    EXPECT_EQ(incidents[0].kind, IncidentKind::kRemoved);
    EXPECT_EQ(stage.world.num_soft_nodes(kSoft), 0U);
    stage.run(0.1);
}

TEST(SoftCloth, CatchesAThrownBall) {
    SoftStage stage;
    SoftObject sheet = curtain_at({0, 0, 1.0});
    sheet.size_m = {1.0, 1.0, 0.01};
    sheet.spacing_m = 0.05;
    sheet.pins = {{PinPlace::kCorners}};
    sheet.world_from_object.rotation =
        Eigen::AngleAxisd(std::numbers::pi / 2.0, Eigen::Vector3d::UnitX());
    ASSERT_EQ(stage.world.add_soft(sheet), AddResult::kAdded);
    ASSERT_EQ(
        stage.world.add({.id = 7,
                         .shape = ObjectShape::kSphere,
                         .size_m = Eigen::Vector3d::Constant(0.15),
                         .mass_kg = 0.3,
                         .world_from_object = {Eigen::Quaterniond::Identity(), {0.05, 0.02, 1.6}}}),
        AddResult::kAdded);
    double lowest_of_cloth = 1e9;
    stage.run(5.0, [&] {
        lowest_of_cloth = std::min(lowest_of_cloth, stage.lowest_m());
        ASSERT_GT(stage.rigid(7).world_from_object.translation.z(), 0.4);
    });
    EXPECT_LT(lowest_of_cloth, 0.85);  // the cloth gave way
}

TEST(SoftWorld, GainsNoEnergyInAMinute) {
    SoftStage stage;
    ASSERT_EQ(stage.world.add_soft(ball_at({0, 0, 0.8})), AddResult::kAdded);
    SoftObject cloth = curtain_at({1.0, 0, 1.1});
    cloth.id = 51;
    ASSERT_EQ(stage.world.add_soft(cloth), AddResult::kAdded);
    stage.run(10.0);
    double fastest = 0.0;
    stage.run(test::kSanitized ? 10.0 : 50.0,
              [&] { fastest = std::max(fastest, stage.fastest_mps()); });
    EXPECT_LT(fastest, 0.15);
    EXPECT_EQ(stage.world.counters().num_not_finite, 0U);
    EXPECT_EQ(stage.world.counters().num_torn, 0U);
}

}  // namespace
}  // namespace atrium::physics
