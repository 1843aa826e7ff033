// A hand starts at full speed into a small ball, beside a still torso in the same mesh.
#include "tests/support/world/physics_meshes.hpp"
#include "ticks.hpp"
#include "world_server/physics/people/person_shape.hpp"
#include "world_server/physics/rigid/body_samples.hpp"
#include "world_server/physics/world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace atrium::physics {
namespace {

using physics_test::make_box_mesh;

constexpr double kBallRadiusM = 0.025;
constexpr int kNumDirections = 20;
const Eigen::Vector3d kHandSizeM{0.04, 0.10, 0.18};     // the forearm continues along -z
const Eigen::Vector3d kForearmSizeM{0.06, 0.07, 0.26};  // overlaps the hand by 1 cm

// A hand and its motion. It rests, then moves along `direction` at `speed_mps`.
struct Hit {
    double speed_mps = 0.0;
    double mesh_hz = 0.0;
    Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
    Eigen::Quaterniond hand_rotation = Eigen::Quaterniond::Identity();
    Eigen::Vector3d start = Eigen::Vector3d::Zero();  // of the hand's centre
    Eigen::Vector3d ball{0.0, 0.0, 1.3};
    double rest_s = 0.0;
    double path_m = 0.0;

    Eigen::Vector3d hand_at(double seconds) const {
        return start + direction * std::clamp(speed_mps * (seconds - rest_s), 0.0, path_m);
    }
};

struct Outcome {
    bool is_hit = false;
    double normal_mps = 0.0;   // the hand's speed along the normal of the face that hits
    double leaving_mps = 0.0;  // the ball's speed along the same normal
    int longest_deep = 0;      // consecutive ticks with the ball deeper than 2 cm inside the hand
    double deepest_m = 0.0;
};

// Depth of the ball inside a box at `centre` [m]. Negative without contact.
double depth_in_box(const Eigen::Vector3d& ball,
                    const Eigen::Vector3d& centre,
                    const Eigen::Quaterniond& rotation,
                    const Eigen::Vector3d& size_m) {
    const Eigen::Vector3d local = rotation.conjugate() * (ball - centre);
    const Eigen::Vector3d q = local.cwiseAbs() - 0.5 * size_m;
    const double outside = q.cwiseMax(0.0).norm();
    const double distance = outside > 0.0 ? outside : q.maxCoeff();
    return kBallRadiusM - distance;
}

Hit make_hit(int trial, double speed_mps, double mesh_hz) {
    std::mt19937 random(static_cast<unsigned>(4000 + trial));
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    Hit hit;
    hit.speed_mps = speed_mps;
    hit.mesh_hz = mesh_hz;
    hit.direction = even_directions(kNumDirections)[static_cast<std::size_t>(trial)].cast<double>();
    // A random orientation with one flat face of the hand, or the fingertips, ahead. The ball meets
    // that face, not its edge.
    const int axis = trial % 3 == 2 ? 2 : 0;
    hit.hand_rotation =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::Unit(axis), hit.direction) *
        Eigen::AngleAxisd(uniform(-0.3, 0.3), Eigen::Vector3d::UnitX()) *
        Eigen::AngleAxisd(uniform(-0.3, 0.3), Eigen::Vector3d::UnitY());
    Eigen::Vector3d ball_in_hand;
    for (int i = 0; i < 3; ++i) {
        const double room_m = 0.5 * kHandSizeM[i] - 0.012;
        ball_in_hand[i] = i == axis ? 0.5 * kHandSizeM[i] + kBallRadiusM : uniform(-room_m, room_m);
    }
    // skip the meshes around the start, which do not show the full speed
    const double gap_m = uniform(0.05, 0.25) + speed_mps / mesh_hz;
    hit.start = hit.ball - hit.hand_rotation * ball_in_hand - gap_m * hit.direction;
    hit.rest_s = 0.2 + uniform(0.0, 1.0 / mesh_hz);
    hit.path_m = gap_m + 0.3;
    return hit;
}

geometry::TriangleMesh mesh_of(const Hit& hit, double seconds, int num_cuts) {
    const Eigen::Vector3d hand = hit.hand_at(seconds);
    const Eigen::Vector3d forearm =
        hand - hit.hand_rotation *
                   Eigen::Vector3d(0, 0, 0.5 * (kHandSizeM.z() + kForearmSizeM.z()) - 0.01);
    geometry::TriangleMesh mesh = make_box_mesh(kHandSizeM, {hit.hand_rotation, hand}, num_cuts);
    append(mesh, make_box_mesh(kForearmSizeM, {hit.hand_rotation, forearm}, num_cuts + 1));
    // beside the path of the hand, as near as the paths of ball and hand allow
    const Eigen::Vector3d side = hit.direction.unitOrthogonal();
    const Eigen::Vector3d torso = hit.start + 0.55 * side;
    append(
        mesh,
        make_box_mesh({0.22, 0.42, 0.65}, {Eigen::Quaterniond::Identity(), torso}, num_cuts + 3));
    return mesh;
}

Outcome play(const Hit& hit) {
    World world({.gravity = {0.0, 0.0, -0.02}});
    world.add({.id = 2,
               .shape = ObjectShape::kSphere,
               .size_m = Eigen::Vector3d::Constant(2.0 * kBallRadiusM),
               .mass_kg = 0.05,
               .world_from_object = {Eigen::Quaterniond::Identity(), hit.ball}});
    PersonShaper shaper({});
    Outcome outcome;
    std::vector<RigidState> states;
    const int ticks_per_mesh = static_cast<int>(std::lround(1.0 / (hit.mesh_hz * kTickS)));
    const double period_s = ticks_per_mesh * kTickS;
    const int num_meshes =
        static_cast<int>((hit.rest_s + hit.path_m / hit.speed_mps) / period_s) + 3;
    int num_deep = 0;
    for (int i = 0; i < num_meshes; ++i) {
        const double captured_s = i * period_s;
        world.set_person("anna",
                         shaper.shape(mesh_of(hit, captured_s, 3 + i % 4),
                                      Timestamp{1'000'000'000 + std::llround(captured_s * 1e9)}));
        for (int tick = 1; tick <= ticks_per_mesh; ++tick) {
            world.tick();
            world.get_states(states);
            const Eigen::Vector3d ball = states[0].world_from_object.translation;
            // the world shows the hand one mesh period late, and interpolates linearly between
            // meshes
            const double share = static_cast<double>(tick) / ticks_per_mesh;
            const Eigen::Vector3d hand = (1.0 - share) * hit.hand_at(captured_s - period_s) +
                                         share * hit.hand_at(captured_s);
            const double depth_m = depth_in_box(ball, hand, hit.hand_rotation, kHandSizeM);
            outcome.deepest_m = std::max(outcome.deepest_m, depth_m);
            num_deep = depth_m > 0.02 ? num_deep + 1 : 0;
            outcome.longest_deep = std::max(outcome.longest_deep, num_deep);
        }
    }
    // along the normal of the face ahead
    const Eigen::Vector3d local = hit.hand_rotation.conjugate() * hit.direction;
    Eigen::Index axis = 0;
    local.cwiseAbs().maxCoeff(&axis);
    const Eigen::Vector3d normal =
        hit.hand_rotation * (Eigen::Vector3d::Unit(axis) * (local[axis] > 0 ? 1.0 : -1.0));
    outcome.normal_mps = hit.speed_mps * normal.dot(hit.direction);
    outcome.leaving_mps = states[0].linear_velocity.dot(normal);
    outcome.is_hit = states[0].linear_velocity.dot(hit.direction) > 0.1 * hit.speed_mps;
    EXPECT_EQ(world.counters().num_not_finite, 0U);
    EXPECT_EQ(world.counters().num_strays, 0U);
    return outcome;
}

class Hand : public testing::TestWithParam<std::tuple<double, double>> {};

TEST_P(Hand, HitsASmallBallFromEveryDirection) {
    const auto [speed_mps, mesh_hz] = GetParam();
    for (int trial = 0; trial < kNumDirections; ++trial) {
        const Outcome outcome = play(make_hit(trial, speed_mps, mesh_hz));
        SCOPED_TRACE(testing::Message() << "trial " << trial << " deepest " << outcome.deepest_m);
        EXPECT_TRUE(outcome.is_hit);
        EXPECT_GE(outcome.leaving_mps, outcome.normal_mps);
        EXPECT_LE(outcome.leaving_mps, 2.2 * outcome.normal_mps);
        EXPECT_LE(outcome.longest_deep, 3);
    }
}

INSTANTIATE_TEST_SUITE_P(SpeedAndMeshRate,
                         Hand,
                         testing::Combine(testing::Values(1.0, 2.0, 4.0, 6.0, 8.0),
                                          testing::Values(20.0, 30.0)));

}  // namespace
}  // namespace atrium::physics
