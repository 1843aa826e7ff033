// People carry, clasp and throw objects. The hands have the noise and the changing triangulation of
// visual hulls.
#include "tests/support/world/physics_meshes.hpp"
#include "ticks.hpp"
#include "world_server/physics/people/person_shape.hpp"
#include "world_server/physics/world.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace atrium::physics {
namespace {

using geometry::RigidTransform;
using physics_test::make_box_mesh;

constexpr double kNoiseM = 0.003;
constexpr int kNumTrials = 10;

struct Slab {
    Eigen::Vector3d size_m;
    RigidTransform pose;
};

// Nobody: an empty list.
using People = std::map<std::string, std::function<std::vector<Slab>(double seconds)>>;

class HoldStage {
public:
    explicit HoldStage(unsigned seed) : random_(seed) {
        world.add({.id = 1, .shape = ObjectShape::kPlane, .size_m = {10, 10, 0}});
    }

    void add(bool is_ball, double size_m, const Eigen::Vector3d& position) {
        ASSERT_EQ(world.add({.id = 2,
                             .shape = is_ball ? ObjectShape::kSphere : ObjectShape::kBox,
                             .size_m = Eigen::Vector3d::Constant(size_m),
                             .mass_kg = 0.2,
                             .world_from_object = {Eigen::Quaterniond::Identity(), position}}),
                  AddResult::kAdded);
    }

    void play(
        double seconds, const People& people, const std::function<void(double)>& look = [](double) {
        }) {
        const int num_meshes = static_cast<int>(std::lround(seconds / kMeshPeriodS));
        for (int i = 0; i < num_meshes; ++i) {
            const double now = i * kMeshPeriodS;
            for (const auto& [name, slabs_at] : people) {
                PersonShaper& shaper =
                    shapers_.try_emplace(name, PersonShapeOptions{}).first->second;
                const Timestamp time{1'000'000'000 + std::int64_t{33'333'333} * num_meshes_};
                world.set_person(name, shaper.shape(noisy_mesh(slabs_at(now)), time));
            }
            ++num_meshes_;
            for (int tick = 0; tick < kTicksPerMesh; ++tick) {
                world.tick();
                fastest_mps = std::max(fastest_mps, object().linear_velocity.norm());
                look(now + tick * kTickS);
            }
        }
    }

    RigidState object() const {
        std::vector<RigidState> states;
        world.get_states(states);
        return states.back();
    }
    Eigen::Vector3d position() const { return object().world_from_object.translation; }

    World world{WorldOptions{}};
    double fastest_mps = 0.0;

private:
    // A different triangulation with different errors each time.
    geometry::TriangleMesh noisy_mesh(const std::vector<Slab>& slabs) {
        geometry::TriangleMesh mesh;
        for (const Slab& slab : slabs) {
            append(mesh,
                   make_box_mesh(slab.size_m, slab.pose, 6 + static_cast<int>(random_() % 5)));
        }
        // a silhouette's errors: a few millimetres, similar for neighbouring points
        constexpr int kNumWaves = 6;
        std::normal_distribution<double> normal;
        for (int wave = 0; wave < kNumWaves; ++wave) {
            const auto any = [&] {
                return Eigen::Vector3d(normal(random_), normal(random_), normal(random_));
            };
            const Eigen::Vector3d along = any().normalized() * (2.0 * std::numbers::pi / 0.12);
            const Eigen::Vector3d shift = any() * (kNoiseM * std::sqrt(2.0 / (3.0 * kNumWaves)));
            const double phase = normal(random_) * std::numbers::pi;
            for (Eigen::Vector3d& v : mesh.vertices) v += std::sin(along.dot(v) + phase) * shift;
        }
        return mesh;
    }

    std::mt19937 random_;
    std::map<std::string, PersonShaper> shapers_;
    int num_meshes_ = 0;
};

Slab slab(const Eigen::Vector3d& size_m,
          const Eigen::Vector3d& position,
          const Eigen::Quaterniond& rotation = Eigen::Quaterniond::Identity()) {
    return {size_m, {rotation, position}};
}

const Eigen::Vector3d kTraySizeM{0.3, 0.3, 0.03};
const Eigen::Vector3d kFlatHandM{0.18, 0.12, 0.04};

struct CarryCase {
    bool is_ball;
    bool is_tray;
    bool rises;
};

class Carry : public testing::TestWithParam<CarryCase> {};

TEST_P(Carry, KeepsAnObjectOnAHandThatMovesAtHalfAMetrePerSecond) {
    const CarryCase c = GetParam();
    const Eigen::Vector3d size_m = c.is_tray ? kTraySizeM : kFlatHandM;
    const double object_m = 0.08;
    int num_kept = 0;
    for (int trial = 0; trial < kNumTrials; ++trial) {
        HoldStage stage(static_cast<unsigned>(100 + trial));
        std::mt19937 random(static_cast<unsigned>(trial));
        std::uniform_real_distribution<double> offset(-0.01, 0.01);
        const double off_x = offset(random);
        const double off_y = offset(random);
        stage.add(c.is_ball, object_m, {off_x, off_y, 1.0 + 0.5 * (size_m.z() + object_m) + 0.005});
        Eigen::Vector3d hand;
        stage.play(3.5, {{"anna", [&](double t) {
                              const double way_m = 0.5 * std::clamp(t - 1.0, 0.0, 2.0);
                              hand = {c.rises ? 0.0 : way_m, 0.0, 1.0 + (c.rises ? way_m : 0.0)};
                              return std::vector<Slab>{slab(size_m, hand)};
                          }}});
        const Eigen::Vector3d on_hand = stage.position() - hand;
        const bool is_on = std::abs(on_hand.x()) < 0.5 * size_m.x() &&
                           std::abs(on_hand.y()) < 0.5 * size_m.y() && on_hand.z() > 0.02;
        num_kept += is_on ? 1 : 0;
        // an object that falls to the floor does so from 2 m at most
        EXPECT_LT(stage.fastest_mps, 6.5);
    }
    EXPECT_EQ(num_kept, kNumTrials);
}

INSTANTIATE_TEST_SUITE_P(OnAHandAndATray,
                         Carry,
                         testing::Values(CarryCase{true, true, false},
                                         CarryCase{true, true, true},
                                         CarryCase{true, false, false},
                                         CarryCase{true, false, true},
                                         CarryCase{false, true, false},
                                         CarryCase{false, true, true}));

// Two upright palms across x, with `gap_m` between them, around `centre`, turned about z by
// `angle_rad`.
std::vector<Slab> palms(const Eigen::Vector3d& centre, double gap_m, double angle_rad) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()));
    const Eigen::Vector3d half = turn * Eigen::Vector3d(0.5 * gap_m + 0.02, 0, 0);
    const Eigen::Vector3d palm_m{0.04, 0.10, 0.18};
    return {slab(palm_m, centre - half, turn), slab(palm_m, centre + half, turn)};
}

double ramp(double t, double from, double seconds) {
    const double s = std::clamp((t - from) / seconds, 0.0, 1.0);
    return s * s * (3.0 - 2.0 * s);
}

constexpr double kObjectM = 0.12;
constexpr double kClaspedM = kObjectM - 0.012;  // each hand presses in by 6 mm

// A table supports the object until it is clasped.
void add_table(HoldStage& stage) {
    ASSERT_EQ(
        stage.world.add({.id = 0,
                         .size_m = {0.05, 0.05, 0.9},
                         .world_from_object = {Eigen::Quaterniond::Identity(), {0, 0, 0.45}}}),
        AddResult::kAdded);
}

double closing_gap(double t) { return 0.3 + (kClaspedM - 0.3) * ramp(t, 0.3, 0.7); }

TEST(Clasp, HoldsABallWhileLiftedMovedByAMetreAndTurnedBy90Degrees) {
    int num_held = 0;
    for (int trial = 0; trial < kNumTrials; ++trial) {
        HoldStage stage(static_cast<unsigned>(300 + trial));
        add_table(stage);
        stage.add(true, kObjectM, {0, 0, 0.9 + 0.5 * kObjectM});
        Eigen::Vector3d centre;
        stage.play(6.0, {{"anna", [&](double t) {
                              centre = {0.0, ramp(t, 1.8, 2.0), 0.96 + 0.3 * ramp(t, 1.1, 0.7)};
                              return palms(centre,
                                           closing_gap(t),
                                           0.5 * std::numbers::pi * ramp(t, 4.0, 1.5));
                          }}});
        num_held += (stage.position() - centre).norm() < 0.07 ? 1 : 0;
    }
    EXPECT_EQ(num_held, kNumTrials);
}

TEST(Clasp, ThrowsAtTheSpeedOfTheHands) {
    for (int trial = 0; trial < 5; ++trial) {
        HoldStage stage(static_cast<unsigned>(700 + trial));
        add_table(stage);
        stage.add(trial % 2 == 0, kObjectM, {0, 0, 0.9 + 0.5 * kObjectM});
        double thrown_mps = 0.0;
        stage.play(2.8,
                   {{"anna",
                     [&](double t) {
                         // along the palms at 2 m/s, which open on the way
                         const double way_m =
                             2.0 * std::clamp(t - 2.0, 0.0, 0.6) * ramp(t, 2.0, 0.3);
                         const Eigen::Vector3d centre{0.0, way_m, 0.96 + 0.3 * ramp(t, 1.1, 0.7)};
                         return palms(centre, closing_gap(t) + 0.2 * ramp(t, 2.35, 0.15), 0.0);
                     }}},
                   [&](double t) {
                       if (t < 2.6) thrown_mps = stage.object().linear_velocity.y();
                   });
        EXPECT_NEAR(thrown_mps, 2.0, 0.2) << "trial " << trial;
    }
}

TEST(Clasp, KeepsSpeedsBoundedWhileSqueezingHarder) {
    for (const bool is_ball : {true, false}) {
        HoldStage stage(900);
        add_table(stage);
        stage.add(is_ball, kObjectM, {0, 0, 0.9 + 0.5 * kObjectM});
        const auto squeeze = [&](double t) {
            return palms({0, 0, 0.96}, closing_gap(t) - 0.04 * ramp(t, 1.5, 2.0), 0.0);
        };
        stage.play(5.0, {{"anna", squeeze}});
        EXPECT_LT(stage.fastest_mps, 6.0);
        EXPECT_EQ(stage.world.counters().num_not_finite, 0U);
    }
}

TEST(StillHand, DoesNotMoveARestingBall) {
    HoldStage stage(1);
    stage.add(true, 0.08, {0, 0, 1.06});
    double fastest_mps = 0.0;
    stage.play(6.0,
               {{"anna",
                 [](double) {
                     return std::vector<Slab>{slab(kTraySizeM, {0, 0, 1.0})};
                 }}},
               [&](double t) {
                   if (t > 1.0) {
                       fastest_mps = std::max(fastest_mps, stage.object().linear_velocity.norm());
                   }
               });
    EXPECT_LT(fastest_mps, 0.25);
    EXPECT_LT(stage.position().head<2>().norm(), 0.08);
}

}  // namespace
}  // namespace atrium::physics
