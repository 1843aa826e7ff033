// Soft things on the floor, on pins, among rigid things and under people's hands.
#include "meshes.hpp"
#include "world_server/physics/person_shape.hpp"
#include "world_server/physics/soft_object.hpp"
#include "world_server/physics/world.hpp"

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

constexpr double kTickS = 1.0 / 120.0;
constexpr double kMeshPeriodS = 1.0 / 30.0;
constexpr std::uint32_t kSoft = 50;

SoftObject ball_at(const Eigen::Vector3d& position) {
    SoftObject ball;
    ball.id = kSoft;
    ball.shape = SoftShape::kBall;
    ball.size_m.setConstant(0.35);
    ball.spacing_m = 0.04;
    ball.mass_kg = 0.5;
    ball.world_from_object.translation = position;
    return ball;
}

SoftObject curtain_at(const Eigen::Vector3d& position) {
    SoftObject cloth;
    cloth.id = kSoft;
    cloth.size_m = {0.7, 1.9, 0.01};
    cloth.spacing_m = 0.08;
    cloth.mass_kg = 0.4;
    cloth.damping_hz = 1.5;
    cloth.pins = {{PinPlace::kTop}};
    cloth.world_from_object.translation = position;
    return cloth;
}

SoftObject rope_at(const Eigen::Vector3d& position) {
    SoftObject rope;
    rope.id = kSoft;
    rope.shape = SoftShape::kRope;
    rope.size_m = {2.0, 0.02, 1.2};
    rope.mass_kg = 0.2;
    rope.pins = {{PinPlace::kLeft}, {PinPlace::kRight}};
    rope.world_from_object.translation = position;
    return rope;
}

// A world with a floor, and one person of whom a mesh comes at 30 Hz.
class Stage {
public:
    Stage() { world.add({.id = 1, .shape = ObjectShape::kPlane, .size_m = {10, 10, 0}}); }

    void run(
        double seconds, const std::function<void()>& look = [] {}) {
        for (int i = 0; i < static_cast<int>(std::lround(seconds / kTickS)); ++i) {
            world.tick();
            look();
        }
    }
    void play(
        double seconds,
        const std::function<geometry::TriangleMesh(double)>& mesh_at,
        const std::function<void(double)>& look = [](double) {}) {
        for (int i = 0; i < static_cast<int>(std::lround(seconds / kMeshPeriodS)); ++i) {
            const Timestamp time{1'000'000'000 + std::int64_t{33'333'333} * num_meshes_++};
            world.set_person("anna", shaper.shape(mesh_at(i * kMeshPeriodS), time));
            for (int tick = 1; tick <= 4; ++tick) {
                world.tick();
                look(i * kMeshPeriodS + tick * kTickS);
            }
        }
    }

    const SoftState& soft(std::uint32_t id = kSoft) {
        world.get_soft_states(states_);
        for (const SoftState& state : states_) {
            if (state.id == id) return state;
        }
        ADD_FAILURE() << "no soft object " << id;
        return states_.front();
    }
    Eigen::Vector3d centre() {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        const SoftState& state = soft();
        for (const Eigen::Vector3f& p : state.positions) sum += p.cast<double>();
        return sum / static_cast<double>(state.positions.size());
    }
    double lowest_m() {
        double low = 1e9;
        for (const Eigen::Vector3f& p : soft().positions) low = std::min<double>(low, p.z());
        return low;
    }
    double fastest_mps() {
        double fastest = 0.0;
        for (const Eigen::Vector3f& v : soft().velocities)
            fastest = std::max<double>(fastest, v.norm());
        return fastest;
    }
    double mean_square_speed() {
        double sum = 0.0;
        const SoftState& state = soft();
        for (const Eigen::Vector3f& v : state.velocities) sum += v.squaredNorm();
        return sum / static_cast<double>(state.velocities.size());
    }
    double volume_m3() {
        const SoftState& state = soft();
        geometry::TriangleMesh mesh;
        for (const Eigen::Vector3f& p : state.positions) mesh.vertices.push_back(p.cast<double>());
        mesh.triangles = world.soft_topology(kSoft)->triangles;
        return geometry::volume_m3(mesh);
    }
    double rope_length_m() {
        const SoftState& state = soft();
        double length = 0.0;
        for (const auto& s : world.soft_topology(kSoft)->segments) {
            length += (state.positions[s[0]] - state.positions[s[1]]).norm();
        }
        return length;
    }
    RigidState rigid(std::uint32_t id) {
        std::vector<RigidState> states;
        world.get_states(states);
        for (const RigidState& state : states) {
            if (state.id == id) return state;
        }
        return {};
    }

    World world{WorldOptions{}};
    PersonShaper shaper{PersonShapeOptions{}};

private:
    int num_meshes_ = 0;
    std::vector<SoftState> states_;
};

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

TEST(SoftObject, SharesIdsAndNodesWithAllOthers) {
    Stage stage;
    SoftObject ball = ball_at({0, 0, 1});
    ball.id = 1;
    EXPECT_EQ(stage.world.add_soft(ball), AddResult::kIdInUse);
    ball.spacing_m = 0.018;  // some 1200 nodes
    for (ball.id = 2; ball.id < 5; ++ball.id) {
        ASSERT_EQ(stage.world.add_soft(ball), AddResult::kAdded);
    }
    EXPECT_EQ(stage.world.add_soft(ball), AddResult::kWorldFull);
    EXPECT_TRUE(stage.world.remove(2));
    EXPECT_FALSE(stage.world.remove(2));
    EXPECT_EQ(stage.world.add_soft(ball), AddResult::kAdded);
}

TEST(SoftBall, RestsOnTheFloorAndKeepsItsVolume) {
    Stage stage;
    ASSERT_EQ(stage.world.add_soft(ball_at({0, 0, 0.5})), AddResult::kAdded);
    const double volume = stage.volume_m3();
    double worst = 0.0;
    stage.run(5.0, [&] {
        worst = std::max(worst, std::abs(stage.volume_m3() / volume - 1.0));
        ASSERT_GT(stage.lowest_m(), -0.002);
    });
    EXPECT_LT(worst, 0.05);
    const Eigen::Vector3d before = stage.centre();
    EXPECT_GT(before.z(), 0.09);  // sags, and stays a ball
    EXPECT_LT(before.z(), 0.18);
    stage.run(5.0);
    EXPECT_LT((stage.centre() - before).norm(), 0.02);
    EXPECT_LT(stage.mean_square_speed(), 0.02 * 0.02);
}

TEST(SoftBox, KeepsItsShape) {
    Stage stage;
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

TEST(SoftModel, IsAnyClosedMesh) {
    Stage stage;
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
    Stage stage;
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
    Stage stage;
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

TEST(SoftRope, CarriesWhatIsTiedToIt) {
    Stage stage;
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
    EXPECT_LT(longest, 1.12);  // swings on the rope, which hardly gives
    EXPECT_LT(stage.rigid(7).world_from_object.translation.z(), 1.9);
    rope.id = 51;
    rope.pins = {{.place = PinPlace::kRight, .object_id = 99}};
    EXPECT_EQ(stage.world.add_soft(rope), AddResult::kInvalid);
    ASSERT_TRUE(stage.world.remove(7));
    stage.run(0.5);  // and nothing of the box is left in the rope
    EXPECT_LT(stage.fastest_mps(), 15.1);
}

TEST(SoftWorld, IsTheSameEachTime) {
    const auto hashes = [] {
        Stage stage;
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

TEST(SoftWorld, GoesOnFromASavedStateAsIfNothingHadBeen) {
    Stage once;
    ASSERT_EQ(once.world.add_soft(ball_at({0, 0, 0.6})), AddResult::kAdded);
    once.run(0.5);
    const SoftState saved = once.soft();
    Stage again;
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

TEST(SoftWorld, PutsBackWhatLeavesIt) {
    Stage stage;
    ASSERT_EQ(stage.world.add_soft(ball_at({0, 0, 0.6})), AddResult::kAdded);
    SoftState far = stage.soft();
    for (Eigen::Vector3f& p : far.positions) p.x() += 100.0F;
    ASSERT_TRUE(stage.world.restore_soft(far));
    stage.run(kTickS);
    EXPECT_EQ(stage.world.counters().num_strays, 1U);
    EXPECT_NEAR(stage.centre().x(), 0.0, 1e-3);
}

// A slab of the size of a hand that starts at full speed against a soft ball on the floor.
class SoftBallPushed : public testing::TestWithParam<double> {};

TEST_P(SoftBallPushed, IsNeverPassedThrough) {
    const double speed = GetParam();
    int num_passed = 0;
    for (int trial = 0; trial < 20; ++trial) {
        std::mt19937 random(2000 + trial);
        const auto uniform = [&](double low, double high) {
            return std::uniform_real_distribution<double>(low, high)(random);
        };
        Stage stage;
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
                // a person lags by one mesh period; a ball whose middle is beside the hand has
                // glanced off its edge
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

TEST(SoftBall, IsNotBlownUpByAPersonWhoAppearsInIt) {
    Stage stage;
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
    EXPECT_LT(stage.centre().z(), 0.2);  // and falls when the person is gone
    EXPECT_NEAR(stage.volume_m3(), 0.022, 0.002);
}

TEST(SoftBall, IsLiftedByTwoArmsFromBelow) {
    Stage stage;
    ASSERT_EQ(stage.world.add_soft(ball_at({0.0, 0, 0.9})), AddResult::kAdded);
    const auto arms = [](double t) {
        const double z = 0.66 + 0.3 * std::clamp(t - 1.0, 0.0, 1.0);
        geometry::TriangleMesh mesh =
            make_box_mesh({0.5, 0.08, 0.08}, {Eigen::Quaterniond::Identity(), {0, -0.09, z}}, 8);
        physics_test::append(
            mesh,
            make_box_mesh({0.5, 0.08, 0.08}, {Eigen::Quaterniond::Identity(), {0, 0.09, z}}, 8));
        return mesh;
    };
    stage.play(3.0, arms);
    EXPECT_GT(stage.centre().z(), 0.96);
    EXPECT_LT(stage.centre().z(), 1.3);
}

TEST(SoftCloth, PartsForAWalkerAndFallsBack) {
    Stage stage;
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

TEST(SoftCloth, CatchesABallThatIsThrownOnIt) {
    Stage stage;
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
    EXPECT_LT(lowest_of_cloth, 0.85);  // it gave way
}

TEST(SoftWorld, GainsNoEnergyInAMinute) {
    Stage stage;
    ASSERT_EQ(stage.world.add_soft(ball_at({0, 0, 0.8})), AddResult::kAdded);
    SoftObject cloth = curtain_at({1.0, 0, 1.1});
    cloth.id = 51;
    ASSERT_EQ(stage.world.add_soft(cloth), AddResult::kAdded);
    stage.run(10.0);
    double fastest = 0.0;
    stage.run(50.0, [&] { fastest = std::max(fastest, stage.fastest_mps()); });
    EXPECT_LT(fastest, 0.15);
    EXPECT_EQ(stage.world.counters().num_not_finite, 0U);
    EXPECT_EQ(stage.world.counters().num_torn, 0U);
}

}  // namespace
}  // namespace atrium::physics
