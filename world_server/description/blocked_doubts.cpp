#include "world_server/description/blocked_doubts.hpp"

#include "world_server/description/joint_motion.hpp"
#include "world_server/description/start_doubts.hpp"
#include "world_server/physics/start_overlap.hpp"
#include "world_server/physics/world.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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
constexpr double kEarly_m = 0.2;

const Way& way_of(const physics::Joint& joint) {
    return joint.kind == physics::JointKind::kHinge ? kTurn : kSlide;
}

// Those in which it is meant to move.
std::vector<double> allowed_directions(const physics::Joint& joint) {
    std::vector<double> directions;
    for (const double direction : {1.0, -1.0})
        if (reach(joint, direction) >= way_of(joint).allowed) directions.push_back(direction);
    return directions;
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
                double direction,
                double enough) {
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
            for (int i = 0; i < num_ticks && furthest < enough; ++i) {
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

struct Obstacle {
    std::string name;                     // empty: nothing
    const WorldObject* object = nullptr;  // null: scenery
};

// What `moving` is deepest inside.
Obstacle obstacle_of(const physics::RigidObject& moving,
                     const physics::Joint& joint,
                     const WorldDescription& world) {
    double deepest_m = 0.0;
    Obstacle obstacle;
    const auto look_at = [&](double depth_m, const std::string& name, const WorldObject* object) {
        if (depth_m <= deepest_m) return;
        deepest_m = depth_m;
        obstacle = {name, object};
    };
    for (const WorldObject& other : world.objects) {
        const bool is_joined = other.rigid.id == joint.a || other.rigid.id == joint.b;
        if (!is_joined && other.rigid.mass_kg != 0.0) continue;
        if (other.rigid.id == moving.id || pass_through(world, moving.id, other.rigid.id)) continue;
        look_at(physics::overlap_m(moving, to_rigid(other)), other.name, &other);
    }
    for (const WorldScenery& scenery : world.scenery) {
        if (scenery.is_solid)
            look_at(physics::overlap_m(moving, scenery.mesh), scenery.name, nullptr);
    }
    return obstacle;
}

// As a drawer in its carcass.
bool is_housed_in(const Obstacle& obstacle, const physics::RigidObject& moving) {
    return obstacle.object != nullptr &&
           start_box_of(to_rigid(*obstacle.object)).contains(start_box_of(moving).centre());
}

// With less than this on its way, something is stuck, or stopped early. What moves in one direction
// only is stopped early within a quarter of its way, though not later than a push lasts.
double enough_of(const physics::Joint& joint, const std::vector<double>& directions) {
    const double moved = way_of(joint).moved;
    if (joint.kind == physics::JointKind::kHinge || directions.size() != 1) return moved;
    return std::clamp(0.25 * reach(joint, directions.front()), moved, kEarly_m);
}

}  // namespace

void doubt_blocked(const WorldDescription& world, std::vector<std::string>& lines) {
    std::optional<Trial> trial;
    for (const physics::Joint& joint : world.joints) {
        const auto motion = motion_of(joint, world);
        if (!motion || !motion->moving->puppet.empty()) continue;
        const physics::RigidObject moving = to_rigid(*motion->moving);
        // a movable carrier, as of a lid, stands still for the trial
        std::optional<physics::RigidObject> carrier;
        if (motion->other != nullptr && motion->other->rigid.mass_kg != 0.0) {
            carrier = to_rigid(*motion->other);
            carrier->mass_kg = 0.0;
        }
        const Way& way = way_of(joint);
        double furthest = 0.0;
        Obstacle obstacle;
        const std::vector<double> directions = allowed_directions(joint);
        const double enough = enough_of(joint, directions);
        for (const double direction : directions) {
            if (furthest >= enough) break;
            if (!trial) trial.emplace(world);
            const double came = trial->push(joint, moving, carrier, direction, enough);
            furthest = std::max(furthest, came);
            physics::RigidObject further = moving;
            further.world_from_object = pose_at(direction * (came + way.further), joint, *motion);
            if (obstacle.name.empty()) obstacle = obstacle_of(further, joint, world);
        }
        const bool is_stuck = furthest < way.moved;
        if (obstacle.name.empty() || furthest >= enough ||
            (!is_stuck && !is_housed_in(obstacle, moving)))
            continue;
        physics::Joint free = joint;
        free.limits.reset();
        const bool is_reversed =
            directions.size() == 1 &&
            trial->push(free, moving, carrier, -directions.front(), enough) >= enough;
        if (!is_stuck && !is_reversed) continue;
        const bool is_hinge = joint.kind == physics::JointKind::kHinge;
        const char* cure =
            is_reversed ? "the other way it is free: reverse axis, or leave 1 cm of air"
            : is_hinge  ? "leave 1 cm of air between them, more where its edge at the hinge turns"
                        : "leave 1 cm of air between them";
        lines.push_back(
            fmt::format("joint_looks_wrong a={} b={} reason=\"pushed, {} {} by {} only, because {} "
                        "stops it; {}\"",
                        object_of(world, joint.a)->name,
                        motion->other == nullptr ? "world" : object_of(world, joint.b)->name,
                        motion->moving->name,
                        is_hinge ? "turns" : "moves",
                        is_hinge ? fmt::format("{:.0f} degrees", furthest / kDeg)
                                 : fmt::format("{:.3f} m", furthest),
                        obstacle.name,
                        cure));
    }
}

}  // namespace atrium::world_server
