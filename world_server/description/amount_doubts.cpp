#include "world_server/description/amount_doubts.hpp"

#include "world_server/description/load_doubts.hpp"
#include "world_server/physics/rigid/collision_shape.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace atrium::world_server {
namespace {

constexpr double kLargestFriction = 5.0;
constexpr double kLeastDensity = 3.0;        // [kg/m^3]; a beach ball has 4.5
constexpr double kLargestDensity = 25000.0;  // [kg/m^3]; osmium has 22600
constexpr double kLargestStretch_m = 3.0;    // of a spring, at the start
constexpr double kAtRest_m = 0.001;

void doubt_friction(const WorldDescription& world, std::vector<std::string>& lines) {
    const auto look_at = [&](const char* kind, const std::string& name, double friction) {
        if (friction <= kLargestFriction) return;
        lines.push_back(
            fmt::format("{}_looks_wrong name={} reason=\"friction = {:.3g} is more than "
                        "any material has: ice has 0.05, wood 0.5, rubber 1\"",
                        kind,
                        name,
                        friction));
    };
    for (const WorldObject& object : world.objects)
        look_at("object", object.name, object.rigid.friction);
    for (const WorldSoftObject& soft : world.soft) look_at("soft", soft.name, soft.object.friction);
    for (const WorldScenery& scenery : world.scenery)
        look_at("scenery", scenery.name, scenery.friction);
}

void doubt_densities(const WorldDescription& world, std::vector<std::string>& lines) {
    for (const WorldObject& object : world.objects) {
        const double mass_kg = object.rigid.mass_kg;
        if (mass_kg == 0.0) continue;
        const double density = mass_kg / physics::volume_m3(to_rigid(object));
        if (density >= kLeastDensity && density <= kLargestDensity) continue;
        lines.push_back(
            fmt::format("object_looks_wrong name={} reason=\"its {:.3g} kg are {:.2g} "
                        "kg/m^3 in its volume, {}: check mass_kg and the size\"",
                        object.name,
                        mass_kg,
                        density,
                        density < kLeastDensity ? "hardly more than air; foam has 40, wood 600"
                                                : "more than any metal; steel has 7800"));
    }
}

// How a spring acts at the start.
struct Pull {
    double stretch_m = 0.0;  // negative: compressed
    double force_n = 0.0;
    const WorldObject* lightest = nullptr;  // of its objects that move
    double speed_mps = 0.0;                 // to which it accelerates that one alone
};

Pull pull_of(const physics::Joint& joint, const WorldDescription& world) {
    Pull pull;
    pull.stretch_m = (joint.anchor_m - joint.anchor_b_m).norm() - joint.rest_length_m;
    if (joint.pulls_only) pull.stretch_m = std::max(pull.stretch_m, 0.0);
    const double length_m = std::abs(pull.stretch_m);
    pull.force_n = joint.stiffness_npm * length_m;
    const bool is_limited = joint.force_max > 0.0 && pull.force_n > joint.force_max;
    if (is_limited) pull.force_n = joint.force_max;
    for (const WorldObject& object : world.objects) {
        const physics::RigidObject& rigid = object.rigid;
        if ((rigid.id != joint.a && rigid.id != joint.b) || rigid.mass_kg == 0.0) continue;
        if (pull.lightest == nullptr || rigid.mass_kg < pull.lightest->rigid.mass_kg)
            pull.lightest = &object;
    }
    if (pull.lightest == nullptr) return pull;
    // all its energy becomes motion, unless its damping balances its force before
    const double energy_j = pull.force_n * length_m * (is_limited ? 1.0 : 0.5);
    pull.speed_mps = std::sqrt(2.0 * energy_j / pull.lightest->rigid.mass_kg);
    if (joint.damping > 0.0)
        pull.speed_mps = std::min(pull.speed_mps, pull.force_n / joint.damping);
    return pull;
}

bool is_movable(const WorldObject* object) {
    return object != nullptr && object->rigid.mass_kg > 0.0;
}

// The force of a weight against `direction` [N].
double weight_n(double mass_kg, const Eigen::Vector3d& direction, const Eigen::Vector3d& gravity) {
    return -mass_kg * gravity.dot(direction);
}

// The largest torque of its weight against the turning, on the way to its limit or in a full
// turn [N m]. `sign`: of its own turning about the axis.
double weight_nm(const WorldObject& object,
                 const physics::Joint& hinge,
                 double sign,
                 const Eigen::Vector3d& gravity) {
    constexpr double kStep_rad = std::numbers::pi / 90.0;
    const Eigen::Vector3d axis = hinge.axis.normalized();
    const Eigen::Vector3d arm = physics::centre_of_mass(to_rigid(object)) - hinge.anchor_m;
    double reach_rad = 2.0 * std::numbers::pi;
    if (hinge.limits)
        reach_rad = hinge.motor_speed > 0.0 ? hinge.limits->at(1) : -hinge.limits->at(0);
    double most_nm = 0.0;
    for (double angle_rad = 0.0; angle_rad <= reach_rad; angle_rad += kStep_rad) {
        const Eigen::Vector3d turned = Eigen::AngleAxisd(sign * angle_rad, axis) * arm;
        const double torque_nm = object.rigid.mass_kg * turned.cross(gravity).dot(axis);
        most_nm = std::max(most_nm, -sign * torque_nm);
    }
    return most_nm;
}

// Motors that cannot move what they drive: away from a limit, or up against its weight.
void doubt_motors(const WorldDescription& world, std::vector<std::string>& lines) {
    std::map<std::uint32_t, double> carried;
    if (std::ranges::any_of(world.joints, [](const auto& joint) { return joint.motor_max > 0.0; }))
        carried = carried_kg(world);
    for (const physics::Joint& joint : world.joints) {
        if (joint.motor_max == 0.0 || joint.motor_speed == 0.0) continue;
        const WorldObject* const a = object_of(world, joint.a);
        const WorldObject* const b = object_of(world, joint.b);
        const auto doubt = [&](const std::string& reason) {
            lines.push_back(fmt::format("joint_looks_wrong a={} b={} reason=\"{}\"",
                                        a == nullptr ? "world" : a->name,
                                        b == nullptr ? "world" : b->name,
                                        reason));
        };
        const bool is_forward = joint.motor_speed > 0.0;
        if (joint.limits && (*joint.limits)[is_forward ? 1 : 0] == 0.0) {
            doubt(
                fmt::format("its motor drives it {} its {} limit of 0, where it starts, so it "
                            "cannot move: turn the sign of the motor's speed, or change the limits",
                            is_forward ? "above" : "below",
                            is_forward ? "upper" : "lower"));
            continue;
        }
        if (is_movable(a) == is_movable(b)) continue;
        const WorldObject& moving = is_movable(a) ? *a : *b;
        const double sign = (is_forward ? 1.0 : -1.0) * (is_movable(a) ? 1.0 : -1.0);
        const bool is_slider = joint.kind == physics::JointKind::kSlider;
        const double load_kg = is_slider ? carried[moving.rigid.id] : 0.0;
        const double needed = is_slider ? weight_n(moving.rigid.mass_kg + load_kg,
                                                   sign * joint.axis.normalized(),
                                                   world.world.gravity)
                                        : weight_nm(moving, joint, sign, world.world.gravity);
        if (needed <= joint.motor_max) continue;
        if (is_slider) {
            doubt(
                fmt::format("its motor has {:.3g} newtons, but {} {} weighs {:.3g} along the "
                            "axis: it cannot lift it: give motor_max_n that and what it carries",
                            joint.motor_max,
                            moving.name,
                            load_kg > 0.0 ? "with what rests on it" : "alone",
                            needed));
        } else {
            doubt(
                fmt::format("its motor has {:.3g} N m, but the weight of {} alone turns it back "
                            "with up to {:.3g}: it sticks there: give motor_max_nm that and what "
                            "it carries, or make it lighter",
                            joint.motor_max,
                            moving.name,
                            needed));
        }
    }
}

void doubt_springs(const WorldDescription& world, std::vector<std::string>& lines) {
    const auto name = [&](std::uint32_t id) {
        const WorldObject* const object = object_of(world, id);
        return object == nullptr ? "world" : object->name;
    };
    for (const physics::Joint& joint : world.joints) {
        if (joint.kind != physics::JointKind::kSpring) continue;
        const Pull pull = pull_of(joint, world);
        if (std::abs(pull.stretch_m) < kAtRest_m || pull.lightest == nullptr) continue;
        if (std::abs(pull.stretch_m) <= kLargestStretch_m &&
            pull.speed_mps <= world.world.max_speed_mps)
            continue;
        lines.push_back(fmt::format(
            "joint_looks_wrong a={} b={} reason=\"rest_length_m = {:.3g}, but its anchors are "
            "{:.3g} "
            "m apart at the start: it {} with {:.2g} newtons, which makes {} up to {:.2g} m/s "
            "fast\"",
            name(joint.a),
            name(joint.b),
            joint.rest_length_m,
            (joint.anchor_m - joint.anchor_b_m).norm(),
            pull.stretch_m > 0.0 ? "pulls" : "pushes",
            pull.force_n,
            pull.lightest->name,
            pull.speed_mps));
    }
}

}  // namespace

void doubt_amounts(const WorldDescription& world, std::vector<std::string>& lines) {
    doubt_friction(world, lines);
    doubt_densities(world, lines);
    doubt_motors(world, lines);
    doubt_springs(world, lines);
}

}  // namespace atrium::world_server
