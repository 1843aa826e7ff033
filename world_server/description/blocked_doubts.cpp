#include "world_server/description/blocked_doubts.hpp"

#include "world_server/description/start_doubts.hpp"
#include "world_server/physics/start_overlap.hpp"
#include "world_server/physics/world.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace atrium::world_server {
namespace {

constexpr double kPush_s = 1.0;
constexpr double kPush_mps2 = 5.0;  // as for 50 N on a door of 10 kg, at its edge
constexpr double kDeg = std::numbers::pi / 180.0;

// Of a hinge [rad] or a slider [m].
struct Way {
    double allowed;  // with so much or more, something is meant to move
    double moved;    // with less than this it is stuck
    double speed;    // of the push [1/s]
    double further;  // from where it is stuck, to find what stops it
};
constexpr Way kTurn{20.0 * kDeg, 15.0 * kDeg, 60.0 * kDeg, 3.0 * kDeg};
constexpr Way kSlide{0.1, 0.025, 0.5, 0.01};

const Way& way_of(const physics::Joint& joint) {
    return joint.kind == physics::JointKind::kHinge ? kTurn : kSlide;
}

// How far a joint lets its object move in a direction (+1, -1).
double reach(const physics::Joint& joint, double direction) {
    if (!joint.limits) return std::numeric_limits<double>::infinity();
    return direction > 0.0 ? joint.limits->at(1) : -joint.limits->at(0);
}

// Those in which it is meant to move.
std::vector<double> allowed_directions(const physics::Joint& joint) {
    std::vector<double> directions;
    for (const double direction : {1.0, -1.0})
        if (reach(joint, direction) >= way_of(joint).allowed) directions.push_back(direction);
    return directions;
}

// The pose of `object` when the joint has moved it from its start.
geometry::RigidTransform moved_by(double way,
                                  const physics::Joint& joint,
                                  const physics::RigidObject& object) {
    const Eigen::Vector3d axis = joint.axis.normalized();
    geometry::RigidTransform motion;
    if (joint.kind == physics::JointKind::kSlider) {
        motion.translation = way * axis;
    } else {
        motion.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(way, axis));
        motion.translation = joint.anchor_m - motion.rotation * joint.anchor_m;
    }
    return motion * object.world_from_object;
}

double way_between(const geometry::RigidTransform& start,
                   const geometry::RigidTransform& now,
                   const physics::Joint& joint) {
    if (joint.kind == physics::JointKind::kSlider)
        return std::abs(joint.axis.normalized().dot(now.translation - start.translation));
    return start.rotation.angularDistance(now.rotation);
}

// All that never moves, and room for one joint.
class Trial {
public:
    explicit Trial(const WorldDescription& world) : description_(world), world_(options_of(world)) {
        for (const WorldObject& object : world.objects)
            if (object.rigid.mass_kg == 0.0) world_.add(to_rigid(object));
        for (const WorldScenery& scenery : world.scenery) {
            if (!scenery.is_solid) continue;
            world_.add_static({.mesh = scenery.mesh,
                               .friction = scenery.friction,
                               .restitution = scenery.restitution});
        }
    }

    /// Pushes `moving` for a second, or until it has moved enough, and returns how far it came.
    double push(physics::Joint joint,
                const physics::RigidObject& moving,
                const std::optional<physics::RigidObject>& carrier,
                double direction) {
        const bool is_hinge = joint.kind == physics::JointKind::kHinge;
        const Way& way = way_of(joint);
        const double arm_m = is_hinge ? start_box_of(moving).size().maxCoeff() : 1.0;
        joint.damping = 0.0;
        joint.motor_speed = direction * way.speed;
        joint.motor_max = kPush_mps2 * moving.mass_kg * arm_m;
        // another joint may let it pass through a fixed object
        std::vector<physics::RigidObject> passed;
        for (const WorldObject& other : description_.objects) {
            if (other.rigid.mass_kg == 0.0 &&
                pass_through(description_, moving.id, other.rigid.id) &&
                other.rigid.id != joint.a && other.rigid.id != joint.b) {
                passed.push_back(to_rigid(other));
                world_.remove(other.rigid.id);
            }
        }
        world_.add(moving);
        if (carrier) world_.add(*carrier);
        double furthest = 0.0;
        if (world_.add_joint(joint)) {
            const int num_ticks = static_cast<int>(kPush_s / description_.world.tick_s);
            for (int i = 0; i < num_ticks && furthest < way.moved; ++i) {
                world_.tick();
                const auto pose = world_.pose_of(moving.id);
                if (!pose) break;
                furthest = std::max(furthest, way_between(moving.world_from_object, *pose, joint));
            }
        }
        world_.remove(moving.id);
        if (carrier) world_.remove(carrier->id);
        for (const physics::RigidObject& other : passed) world_.add(other);
        return furthest;
    }

private:
    static physics::WorldOptions options_of(const WorldDescription& world) {
        physics::WorldOptions options = world.world;
        options.gravity.setZero();
        return options;
    }

    const WorldDescription& description_;
    physics::World world_;
};

// What `moving` is deepest inside; empty: nothing.
std::string obstacle_of(const physics::RigidObject& moving,
                        const physics::Joint& joint,
                        const WorldDescription& world) {
    double deepest_m = 0.0;
    std::string name;
    const auto look_at = [&](double depth_m, const std::string& of) {
        if (depth_m <= deepest_m) return;
        deepest_m = depth_m;
        name = of;
    };
    for (const WorldObject& other : world.objects) {
        const bool is_joined = other.rigid.id == joint.a || other.rigid.id == joint.b;
        if (!is_joined && other.rigid.mass_kg != 0.0) continue;
        if (other.rigid.id == moving.id || pass_through(world, moving.id, other.rigid.id)) continue;
        look_at(physics::overlap_m(moving, to_rigid(other)), other.name);
    }
    for (const WorldScenery& scenery : world.scenery)
        if (scenery.is_solid) look_at(physics::overlap_m(moving, scenery.mesh), scenery.name);
    return name;
}

}  // namespace

void doubt_blocked(const WorldDescription& world, std::vector<std::string>& lines) {
    std::optional<Trial> trial;
    for (const physics::Joint& joint : world.joints) {
        if (joint.kind != physics::JointKind::kHinge && joint.kind != physics::JointKind::kSlider)
            continue;
        const WorldObject* a = object_of(world, joint.a);
        const WorldObject* b = object_of(world, joint.b);
        if (a == nullptr || !a->puppet.empty()) continue;
        const bool a_moves = a->rigid.mass_kg != 0.0;
        if (!a_moves && (b == nullptr || b->rigid.mass_kg == 0.0)) continue;
        const physics::RigidObject moving = to_rigid(a_moves ? *a : *b);
        // a movable carrier, as of a lid, stands still for the trial
        std::optional<physics::RigidObject> carrier;
        if (a_moves && b != nullptr && b->rigid.mass_kg != 0.0) {
            carrier = to_rigid(*b);
            carrier->mass_kg = 0.0;
        }
        const Way& way = way_of(joint);
        double furthest = 0.0;
        std::string obstacle;
        const std::vector<double> directions = allowed_directions(joint);
        for (const double direction : directions) {
            if (furthest >= way.moved) break;
            if (!trial) trial.emplace(world);
            const double came = trial->push(joint, moving, carrier, direction);
            furthest = std::max(furthest, came);
            physics::RigidObject further = moving;
            further.world_from_object =
                moved_by((a_moves ? direction : -direction) * (came + way.further), joint, moving);
            if (obstacle.empty()) obstacle = obstacle_of(further, joint, world);
        }
        if (obstacle.empty() || furthest >= way.moved) continue;
        physics::Joint free = joint;
        free.limits.reset();
        const bool is_reversed =
            directions.size() == 1 &&
            trial->push(free, moving, carrier, -directions.front()) >= way.moved;
        const bool is_hinge = joint.kind == physics::JointKind::kHinge;
        const char* cure =
            is_reversed ? "the other way it is free: reverse axis, or leave 1 cm of air"
            : is_hinge  ? "leave 1 cm of air between them, more where its edge at the hinge turns"
                        : "leave 1 cm of air between them";
        lines.push_back(
            fmt::format("joint_looks_wrong a={} b={} reason=\"pushed, {} {} by {} only, because {} "
                        "stops it; {}\"",
                        a->name,
                        b == nullptr ? "world" : b->name,
                        a_moves ? a->name : b->name,
                        is_hinge ? "turns" : "moves",
                        is_hinge ? fmt::format("{:.0f} degrees", furthest / kDeg)
                                 : fmt::format("{:.3f} m", furthest),
                        obstacle,
                        cure));
    }
}

}  // namespace atrium::world_server
