#include "tests/support/world/act_motion.hpp"
#include "tests/support/world/acts.hpp"
#include "tests/support/world/physics_meshes.hpp"

#include <fmt/format.h>

namespace atrium::test {

using Eigen::Vector3d;
using geometry::RigidTransform;
using simulation::BodyPose;

namespace {

// A flat hand, thin along x and long along z, and a round arm behind it. A hand alone covers too
// few pixels of a camera that sees a whole room.
geometry::TriangleMesh hand_and_arm(const Vector3d& half_size_of_hand) {
    const geometry::TriangleMesh ball = physics_test::make_sphere_mesh(1.0, Vector3d::Zero(), 16);
    geometry::TriangleMesh hand = ball;
    for (Vector3d& v : hand.vertices) v = v.cwiseProduct(half_size_of_hand);
    geometry::TriangleMesh arm = ball;
    for (Vector3d& v : arm.vertices) {
        const double radius = 0.05 - 0.02 * v.z();
        v = {radius * v.x(), radius * v.y(), 0.28 * v.z() - 0.33};
    }
    geometry::append(hand, arm);
    return hand;
}

}  // namespace

KickAct kick(std::uint64_t seed) {
    Random random(6000 + seed);
    KickAct kick;
    const std::string look = random_look(random);
    const double heading = between(random, -std::numbers::pi, std::numbers::pi);
    const double speed = between(random, 2.0, 5.0);
    const double scale = scale_of(look);
    constexpr double kLegM = 0.80;
    constexpr double kBackRad = 0.9;
    constexpr double kStillS = 0.3;
    kick.diameter_m = between(random, 0.18, 0.24);
    kick.speed_mps = speed;
    const RigidTransform feet = upright({0.0, 0.0, 0.0}, heading);
    kick.forwards_site = feet.rotation * Vector3d::UnitY();
    kick.ball_site = feet * Vector3d(scale * 0.11 + between(random, -0.03, 0.03),
                                     scale * 0.24 + 0.5 * kick.diameter_m,
                                     0.5 * kick.diameter_m);
    kick.act.name = "kick" + std::to_string(seed);
    kick.act.look = look;
    // from the back it accelerates evenly to the lowest point, then decelerates evenly
    const double rate = speed / (scale * kLegM);
    const double swing_s = 2.0 * kBackRad / rate;
    kick.act.seconds = kStillS + 2.0 * swing_s + 0.4;
    kick.act.site_from_feet = [feet](double) { return feet; };
    kick.act.pose = [=](double t) {
        const double up = std::clamp(t - kStillS, 0.0, swing_s);
        const double down = std::clamp(t - kStillS - swing_s, 0.0, swing_s);
        const double angle = -kBackRad + 0.5 * rate / swing_s * up * up + rate * down -
                             0.5 * rate / swing_s * down * down;
        BodyPose pose;
        pose.right_leg.ankle = {
            0.11, kLegM * std::sin(angle), 0.93 - 0.012 - kLegM * std::cos(angle)};
        pose.right_leg.toe_down_rad = 0.3;
        return pose;
    };
    kick.act.site_from_grip = [feet](double) { return feet; };
    return kick;
}

StrikeAct strike(const Vector3d& target_site,
                 const Vector3d& direction,
                 double speed_mps,
                 std::uint64_t seed) {
    Random random(7000 + seed);
    constexpr double kRunUpM = 0.6;   // distance of the acceleration
    constexpr double kBeforeM = 0.1;  // at full speed to the target
    constexpr double kBeyondM = 0.25;
    constexpr double kStopM = 0.3;
    constexpr double kStillS = 0.2;
    const Vector3d half_size(0.02, 0.045, 0.09);
    const double run_up_s = 2.0 * kRunUpM / speed_mps;
    const double even_s = (kBeforeM + kBeyondM) / speed_mps;
    const double stop_s = 2.0 * kStopM / speed_mps;
    const Vector3d forwards = direction.normalized();
    StrikeAct act;
    act.act.name = fmt::format("strike{}_{:g}mps_{:.3f}_{:.3f}_{:.3f}",
                               seed,
                               speed_mps,
                               forwards.x(),
                               forwards.y(),
                               forwards.z());
    act.act.seconds = kStillS + run_up_s + even_s + stop_s + 0.2;
    act.contact_s = kStillS + run_up_s + kBeforeM / speed_mps;
    act.velocity_site = speed_mps * forwards;
    const double tilt = between(random, -0.35, 0.35);
    const double about = between(random, -std::numbers::pi, std::numbers::pi);
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitX(), forwards) *
        Eigen::AngleAxisd(about, Vector3d::UnitX()) * Eigen::AngleAxisd(tilt, Vector3d::UnitY());
    const Vector3d normal = turn * Vector3d::UnitX();
    act.palm_normal_site = normal;
    // the ball meets the palm up to 1.5 cm off its middle
    const Vector3d off =
        turn * Vector3d(0.0, between(random, -0.015, 0.015), between(random, -0.015, 0.015));
    act.act.prop = hand_and_arm(half_size);
    const auto place = [=](double t) {
        const double up = std::clamp(t - kStillS, 0.0, run_up_s);
        const double even = std::clamp(t - kStillS - run_up_s, 0.0, even_s);
        const double down = std::clamp(t - kStillS - run_up_s - even_s, 0.0, stop_s);
        const double way = 0.5 * speed_mps / run_up_s * up * up + speed_mps * even +
                           speed_mps * down - 0.5 * speed_mps / stop_s * down * down;
        const double from_target = way - kRunUpM - kBeforeM;
        return RigidTransform{turn,
                              target_site + off + from_target * forwards - half_size.x() * normal};
    };
    act.act.site_from_prop = place;
    act.act.site_from_grip = place;
    return act;
}

}  // namespace atrium::test
