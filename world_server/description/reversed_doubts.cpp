#include "world_server/description/reversed_doubts.hpp"

#include "world_server/description/joint_motion.hpp"
#include "world_server/description/start_doubts.hpp"
#include "world_server/physics/start_overlap.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

namespace atrium::world_server {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// Of a hinge [rad]: a limit this near to the start closes, and the other one opens at least so far.
constexpr double kClosed_rad = 5.0 * kDegree;
constexpr double kOpen_rad = 20.0 * kDegree;
// Parts that pass through each other often overlap a little, also where the hinge is right.
constexpr double kMoreOverlap_m = 0.05;
constexpr double kFree_m = 0.02;
constexpr std::array kShares{0.25, 0.5, 0.75, 1.0};  // of the way

// Of a slider [m]
constexpr double kClosed_m = 0.01;
constexpr double kOpen_m = 0.05;
// A board of a drawer that crosses a board of its carcass overlaps it by its thickness only: parts
// are at least 4 mm thick.
constexpr double kBoard_m = 0.0035;
constexpr double kNoBoard_m = 0.001;
constexpr double kFurther_m = 0.05;  // it goes on from where it meets the board
constexpr int kNumPlaces = 16;

// The direction in which a joint opens, as a sign; 0: both, or neither.
double opens_towards(const physics::Joint& joint, double closed, double open) {
    for (const double sign : {1.0, -1.0})
        if (reach(joint, -sign) <= closed && reach(joint, sign) >= open) return sign;
    return 0.0;
}

using DepthAt = std::function<double(double place)>;  // [rad, m], as the joint's limits count

// Where a hinge that opens until `end_rad` is deepest in its other object, and how deep.
struct Deepest {
    double at_rad, depth_m;
};

std::optional<Deepest> find_deepest(const DepthAt& depth_at, double end_rad) {
    const double before_m = depth_at(0.0);
    Deepest deepest{0.0, 0.0};
    for (const double share : kShares) {
        const double depth_m = depth_at(share * end_rad);
        if (depth_m > deepest.depth_m) deepest = {share * end_rad, depth_m};
        if (depth_at(-share * end_rad) > before_m + kFree_m) return std::nullopt;
    }
    if (deepest.depth_m < before_m + kMoreOverlap_m) return std::nullopt;
    return deepest;
}

// From where on a slider that opens until `end_m` is in its other object.
std::optional<double> find_entry(const DepthAt& depth_at, double end_m) {
    const double before_m = depth_at(0.0), step_m = end_m / kNumPlaces;
    int entry = kNumPlaces + 1;
    while (entry > 1 && depth_at((entry - 1) * step_m) >= before_m + kBoard_m) --entry;
    if ((kNumPlaces - entry) * std::abs(step_m) < kFurther_m) return std::nullopt;
    for (int i = 1; i <= kNumPlaces; ++i)
        if (depth_at(-i * step_m) > before_m + kNoBoard_m) return std::nullopt;
    return entry * step_m;
}

// A drawer starts in its carcass, and a door at its wall. What starts outside, as a bolt or an
// extended telescope, may be meant to go in.
bool starts_inside(const JointMotion& motion) {
    const geometry::Aabb box = start_box_of(to_rigid(*motion.other));
    return box.contains(start_box_of(to_rigid(*motion.moving)).centre());
}

}  // namespace

void doubt_reversed(const WorldDescription& world, std::vector<std::string>& lines) {
    for (const physics::Joint& joint : world.joints) {
        const auto motion = motion_of(joint, world);
        if (!motion || motion->other == nullptr || joint.collides || !joint.limits) continue;
        const bool is_hinge = joint.kind == physics::JointKind::kHinge;
        const double direction = is_hinge ? opens_towards(joint, kClosed_rad, kOpen_rad)
                                          : opens_towards(joint, kClosed_m, kOpen_m);
        if (direction == 0.0 || (!is_hinge && !starts_inside(*motion))) continue;
        const physics::RigidObject other = to_rigid(*motion->other);
        const DepthAt depth_at = [&](double place) {
            physics::RigidObject moved = to_rigid(*motion->moving);
            moved.world_from_object = pose_at(place, joint, *motion);
            return physics::overlap_m(moved, other);
        };
        const double end = direction * reach(joint, direction);
        std::string where;
        if (is_hinge) {
            if (const auto deepest = find_deepest(depth_at, end))
                where = fmt::format("at {:.0f} degrees {} is {:.2f} m inside {}",
                                    deepest->at_rad / kDegree,
                                    motion->moving->name,
                                    deepest->depth_m,
                                    motion->other->name);
        } else if (const auto entry_m = find_entry(depth_at, end)) {
            where = fmt::format("from {:.2f} m on {} goes through {}",
                                *entry_m,
                                motion->moving->name,
                                motion->other->name);
        }
        if (where.empty()) continue;
        lines.push_back(
            fmt::format("joint_looks_wrong a={} b={} reason=\"{}, and the other way it is free: "
                        "reverse axis, or, if they shall stop each other, write collide = true\"",
                        object_of(world, joint.a)->name,
                        object_of(world, joint.b)->name,
                        where));
    }
}

}  // namespace atrium::world_server
