#include "tests/support/world/act_motion.hpp"
#include "tests/support/world/acts.hpp"

namespace atrium::test {
namespace {

using Eigen::Vector3d;
using geometry::RigidTransform;
using simulation::BodyPose;

constexpr double kOpenM = 0.12;  // open palms are this much further apart than the object's width
constexpr double kCloseS = 0.6;  // duration of closing
constexpr double kForwardsM =
    0.33;  // from the body's middle to the held object; within reach of the lower arm
constexpr double kLiftM = 0.12;
const Vector3d kElbow(0.7, -0.6, -0.8);

// Both palms face each other around a place in front of the chest, `gap` apart. Slant 0: the right
// palm is below and the left one above. 90 degrees: right and left. With a lean the right palm is
// also behind.
struct Clasp {
    double scale = 1.0;
    double slant_rad = 0.0;
    double lean_rad = 0.0;

    void apply(BodyPose& pose, const Vector3d& middle_m, double gap_m) const {
        const Eigen::Quaterniond lean(Eigen::AngleAxisd(-lean_rad, Vector3d::UnitX()));
        const Vector3d axis = lean * Vector3d(-std::sin(slant_rad), 0.0, std::cos(slant_rad));
        const Vector3d fingers = lean * Vector3d::UnitY();
        const Vector3d half = 0.5 * gap_m * axis;
        const double level = std::abs(std::sin(slant_rad));
        const Vector3d upper_elbow = level * kElbow + (1.0 - level) * Vector3d(1.0, -0.3, 0.3);
        pose.right_arm = reach(middle_m - half, fingers, axis, kElbow, scale);
        pose.left_arm =
            reach(mirrored(middle_m + half), fingers, mirrored(-axis), upper_elbow, scale);
    }

private:
    static Vector3d mirrored(const Vector3d& p) { return {-p.x(), p.y(), p.z()}; }
};

double way(const Vector3d& p) { return p.norm(); }

}  // namespace

ClaspAct clasp_move_turn(std::uint64_t seed, bool level) {
    Random random(3000 + seed);
    const std::string look = random_look(random);
    const double scale = scale_of(look);
    const double width = between(random, 0.16, 0.22);
    const double squeeze = between(random, 0.015, 0.03);
    const double height = scale * between(random, 1.20, 1.26);
    const double heading = between(random, -std::numbers::pi, std::numbers::pi);
    const double turn = (between(random, 0, 1) == 0 ? -0.5 : 0.5) * std::numbers::pi;
    const double towards = between(random, -std::numbers::pi, std::numbers::pi);
    const double move_s = between(random, 2.2, 2.8);  // up to 0.85 m/s
    const double slant = level ? 0.5 * std::numbers::pi : between(random, -0.35, 0.35);
    const Clasp hands{scale, slant};
    constexpr double kStillS = 0.4;
    ClaspAct clasp;
    clasp.width_m = width;
    clasp.closed_s = kStillS + kCloseS;
    const double lift_start_s = clasp.closed_s + 0.25;
    clasp.lifted_s = lift_start_s + 0.5;
    clasp.end_s = clasp.lifted_s + move_s;
    clasp.act.name = (level ? "level" : "clasp") + std::to_string(seed);
    clasp.act.look = look;
    clasp.act.seconds = clasp.end_s + 0.4;
    const double lifted_s = clasp.lifted_s;
    // the object, not the feet, moves by one metre: the turn moves it as well
    const auto thing = [=](double heading_now) {
        return Vector3d(upright(Vector3d::Zero(), heading_now) * Vector3d(0.0, kForwardsM, 0.0));
    };
    const Vector3d step_m(std::cos(towards), std::sin(towards), 0.0);
    const Vector3d feet_way = step_m - thing(heading + turn) + thing(heading);
    const Vector3d feet_start = -0.5 * feet_way;
    const auto feet = [=](double t) {
        const double done = ease(t, lifted_s, move_s);
        return upright(feet_start + done * feet_way, heading + done * turn);
    };
    const auto middle = [=](double t) {
        return Vector3d(0.0, kForwardsM, height + kLiftM * ease(t, lift_start_s, 0.5));
    };
    clasp.act.site_from_feet = feet;
    clasp.act.pose = [=](double t) {
        BodyPose pose;
        step(pose, 3.0 * way(feet_way) * ease(t, lifted_s, move_s), 0.06);
        const double gap = width + kOpenM - (kOpenM + squeeze) * ease(t, kStillS, kCloseS);
        hands.apply(pose, middle(t), gap);
        return pose;
    };
    clasp.act.site_from_grip = [=](double t) {
        const RigidTransform now = feet(t);
        return RigidTransform{now.rotation, now * middle(t)};
    };
    return clasp;
}

HandOverAct hand_over(std::uint64_t seed) {
    Random random(4000 + seed);
    HandOverAct act;
    act.giver.name = "giver" + std::to_string(seed);
    act.taker.name = "taker" + std::to_string(seed);
    act.giver.look = random_look(random);
    act.taker.look = random_look(random);
    const double giver_scale = scale_of(act.giver.look);
    const double taker_scale = scale_of(act.taker.look);
    const double width = between(random, 0.15, 0.20);
    const double giver_squeeze = between(random, 0.015, 0.03);
    const double taker_squeeze = between(random, 0.015, 0.03);
    const double height = std::max(giver_scale, taker_scale) * between(random, 1.20, 1.24);
    const double aside = between(random, -0.03, 0.03);  // sideways offset of the taker
    const double late_s = between(random, 0.0, 0.3);
    // in the world the two clasps cross, because the people face each other
    const Clasp giver_hands{giver_scale, between(random, 0.25, 0.4)};
    const Clasp taker_hands{taker_scale, between(random, 0.25, 0.4)};
    act.width_m = width;
    constexpr double kForwards = -0.5 * std::numbers::pi;  // turns the body's +Y to +X of the site
    constexpr double kWalkM = 0.46;
    constexpr double kWalkS = 1.4;
    const double closed_s = 0.3 + kCloseS;
    const double lift_s = closed_s + 0.25;
    const double walk_s = lift_s + 0.4;
    const double close_s = walk_s + kWalkS + 0.1 + late_s;  // the taker begins to close the palms
    act.taken_s = close_s + kCloseS;
    const double open_s = act.taken_s + 0.3;
    act.opened_s = open_s + 0.5;
    act.end_s = act.opened_s + 1.0;
    act.giver.seconds = act.taker.seconds = act.end_s + 0.4;
    const double opened_s = act.opened_s;
    const double between_rooms_m = 2.0 * (kWalkM + kForwardsM);
    act.world_from_giver = upright({-0.5 * between_rooms_m, 0.0, 0.0}, 0.0);
    act.world_from_taker = upright({0.5 * between_rooms_m, 0.0, 0.0}, std::numbers::pi);

    const auto giver_feet = [=](double t) {
        const double x = kWalkM * ease(t, walk_s, kWalkS) - 0.4 * ease(t, opened_s, 1.0);
        return upright({x, 0.0, 0.0}, kForwards);
    };
    const auto taker_feet = [=](double t) {
        const double x = kWalkM * ease(t, walk_s, kWalkS) - 0.3 * ease(t, opened_s, 1.0);
        return upright({x, aside, 0.0}, kForwards);
    };
    const Vector3d lifted(0.0, kForwardsM, height + kLiftM);
    const auto giver_middle = [=](double t) {
        return Vector3d(0.0, kForwardsM, height + kLiftM * ease(t, lift_s, 0.4));
    };
    act.giver.site_from_feet = giver_feet;
    act.taker.site_from_feet = taker_feet;
    act.giver.pose = [=](double t) {
        BodyPose pose;
        step(pose, 2.0 * ease(t, walk_s, kWalkS) + 2.0 * ease(t, opened_s, 1.0), 0.05);
        const double gap = width + kOpenM - (kOpenM + giver_squeeze) * ease(t, 0.3, kCloseS) +
                           (kOpenM + giver_squeeze) * ease(t, open_s, 0.5);
        giver_hands.apply(pose, giver_middle(t), gap);
        return pose;
    };
    act.taker.pose = [=](double t) {
        BodyPose pose;
        step(pose, 2.0 * ease(t, walk_s, kWalkS) + 2.0 * ease(t, opened_s, 1.0), 0.05);
        const double gap = width + kOpenM - (kOpenM + taker_squeeze) * ease(t, close_s, kCloseS);
        taker_hands.apply(pose, lifted, gap);
        return pose;
    };
    act.giver.site_from_grip = [=](double t) {
        const RigidTransform feet = giver_feet(t);
        return RigidTransform{feet.rotation, feet * giver_middle(t)};
    };
    act.taker.site_from_grip = [=](double t) {
        const RigidTransform feet = taker_feet(t);
        return RigidTransform{feet.rotation, feet * lifted};
    };
    return act;
}

ThrowAct throw_forwards(std::uint64_t seed) {
    Random random(5000 + seed);
    ThrowAct thrown;
    const std::string look = random_look(random);
    const double scale = scale_of(look);
    const double width = between(random, 0.14, 0.20);
    const double squeeze = between(random, 0.015, 0.03);
    const double height = scale * between(random, 1.22, 1.28);
    const double heading = between(random, -std::numbers::pi, std::numbers::pi);
    const double speed = between(random, 1.5, 2.5);
    constexpr double kLean = 0.8;  // the right palm pushes from behind
    const Clasp hands{scale, between(random, -0.2, 0.2), kLean};
    constexpr double kStrokeM = 0.36;
    constexpr double kArms = 0.30;
    constexpr double kLetGoM = 0.22;      // wide enough for an object that falls on its way
    constexpr double kOpenEarlyS = 0.06;  // the palms open while they are fast
    const double closed_s = 0.3 + kCloseS;
    const double start_s = closed_s + 0.3;
    const double stroke_s = 2.0 * kStrokeM / speed;  // with constant acceleration
    thrown.width_m = width;
    thrown.speed_mps = speed;
    thrown.release_s = start_s + stroke_s;
    thrown.forwards_site = upright(Vector3d::Zero(), heading) * Vector3d(0.0, 1.0, 0.0);
    thrown.act.name = "throw" + std::to_string(seed);
    thrown.act.look = look;
    thrown.act.seconds = thrown.release_s + 0.5;
    const double release_s = thrown.release_s;
    // the arms cover this part of the distance, a step the rest
    const auto forwards = [=](double t) {
        const double up = std::clamp(t - start_s, 0.0, stroke_s);
        const double down = std::clamp(t - release_s, 0.0, 0.1);
        return 0.5 * speed / stroke_s * up * up + speed * down - 0.5 * speed * down * down / 0.1;
    };
    const auto feet = [=](double t) {
        const RigidTransform turned = upright(Vector3d::Zero(), heading);
        return upright(turned * Vector3d(0.0, (1.0 - kArms) * forwards(t) - 0.5, 0.0), heading);
    };
    const auto middle = [=](double t) { return Vector3d(0.0, 0.27 + kArms * forwards(t), height); };
    thrown.act.site_from_feet = feet;
    thrown.act.pose = [=](double t) {
        BodyPose pose;
        pose.left_leg.ankle.y() += 0.15;
        pose.right_leg.ankle.y() -= 0.15;
        const double gap = width + kOpenM - (kOpenM + squeeze) * ease(t, 0.3, kCloseS) +
                           kLetGoM * ease(t, release_s - kOpenEarlyS, 0.16);
        hands.apply(pose, middle(t), gap);
        return pose;
    };
    thrown.act.site_from_grip = [=](double t) {
        const RigidTransform now = feet(t);
        return RigidTransform{now.rotation, now * middle(t)};
    };
    return thrown;
}

}  // namespace atrium::test
