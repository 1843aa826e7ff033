#include "tests/support/world/act_motion.hpp"
#include "tests/support/world/acts.hpp"
#include "tests/support/world/physics_meshes.hpp"

namespace atrium::test {
namespace {

using Eigen::Vector3d;
using geometry::RigidTransform;
using simulation::BodyPose;

constexpr double kSpeed = 0.5;       // [m/s] sideways and upwards
constexpr double kSeconds = 2.0;     // at that speed
constexpr double kStillS = 0.8;      // before the motion: a falling object comes to rest
constexpr double kEndS = 0.5;        // after the motion
constexpr double kLowM = 0.65;       // height of palm or tray at the beginning
constexpr double kForwardsM = 0.33;  // from the body's middle to the palms
constexpr double kCrouchM = 0.34;    // the body crouches by this much at the beginning
const Vector3d kTraySize(0.40, 0.28, 0.02);

// Place of the body, and height of the palm or tray.
struct CarryMotion {
    double start_s = kStillS;
    double ramp_s = 0.3;
    double side = 1.0;  // direction of the motion: 1 is to the right
    double heading_rad = 0.0;
    Vector3d offset = Vector3d::Zero();

    double length_m() const { return kSpeed * (kSeconds + ramp_s); }
    double way_m(double t) const { return glide(t, start_s, kSpeed, ramp_s, kSeconds); }
    double height_m(double t) const { return kLowM + way_m(t); }
    RigidTransform site_from_feet(double t) const {
        const RigidTransform turned = upright(offset, heading_rad);
        const double sideways = side * (way_m(t) - 0.5 * length_m());
        return upright(turned * Vector3d(sideways, -0.25, 0.0), heading_rad);
    }
    BodyPose stance(double t) const {
        BodyPose pose;
        const double risen = way_m(t) / length_m();
        pose.shift.z() -= kCrouchM * (1.0 - risen);
        step(pose, 2.5 * way_m(t), 0.05);
        return pose;
    }
};

CarryMotion draw(Random& random) {
    CarryMotion motion;
    motion.ramp_s = between(random, 0.2, 0.35);
    motion.side = between(random, 0, 1) == 0 ? -1.0 : 1.0;
    motion.heading_rad = between(random, -std::numbers::pi, std::numbers::pi);
    motion.offset = {between(random, -0.05, 0.05), between(random, -0.05, 0.05), 0.0};
    return motion;
}

CarryAct make_carry(const CarryMotion& motion, const std::string& look) {
    CarryAct carry;
    carry.start_s = motion.start_s;
    carry.end_s = motion.start_s + kSeconds + 2.0 * motion.ramp_s;
    carry.act.look = look;
    carry.act.seconds = carry.end_s + kEndS;
    carry.act.site_from_feet = [motion](double t) { return motion.site_from_feet(t); };
    return carry;
}

const Vector3d kElbow(0.7, -0.6, -0.8);

}  // namespace

CarryAct carry_on_palm(std::uint64_t seed) {
    Random random(1000 + seed);
    const CarryMotion motion = draw(random);
    const std::string look = random_look(random);
    const double scale = scale_of(look);
    const double side_m = between(random, 0.10, 0.20);
    CarryAct carry = make_carry(motion, look);
    carry.act.name = "palm" + std::to_string(seed);
    carry.act.pose = [=](double t) {
        BodyPose pose = motion.stance(t);
        pose.right_arm = reach({side_m, kForwardsM, motion.height_m(t)},
                               Vector3d::UnitY(),
                               Vector3d::UnitZ(),
                               kElbow,
                               scale);
        return pose;
    };
    carry.act.site_from_grip = [=](double t) {
        const RigidTransform feet = motion.site_from_feet(t);
        return RigidTransform{feet.rotation,
                              feet * Vector3d(side_m, kForwardsM, motion.height_m(t))};
    };
    return carry;
}

CarryAct carry_on_tray(std::uint64_t seed) {
    Random random(2000 + seed);
    const CarryMotion motion = draw(random);
    const std::string look = random_look(random);
    const double scale = scale_of(look);
    CarryAct carry = make_carry(motion, look);
    carry.act.name = "tray" + std::to_string(seed);
    carry.act.pose = [=](double t) {
        BodyPose pose = motion.stance(t);
        pose.right_arm = reach({0.13, kForwardsM, motion.height_m(t) - kTraySize.z()},
                               Vector3d::UnitY(),
                               Vector3d::UnitZ(),
                               kElbow,
                               scale);
        pose.left_arm = pose.right_arm;
        return pose;
    };
    carry.act.prop = physics_test::make_box_mesh(kTraySize, {}, 6);
    const auto grip = [=](double t) {
        const RigidTransform feet = motion.site_from_feet(t);
        return RigidTransform{feet.rotation,
                              feet * Vector3d(0.0, kForwardsM + 0.04, motion.height_m(t))};
    };
    carry.act.site_from_grip = grip;
    carry.act.site_from_prop = [=](double t) {
        RigidTransform middle = grip(t);
        middle.translation.z() -= 0.5 * kTraySize.z();
        return middle;
    };
    return carry;
}

}  // namespace atrium::test
