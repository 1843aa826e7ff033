#include "world_server/description/hinge_doubts.hpp"

#include "world_server/description/start_doubts.hpp"
#include "world_server/physics/start_overlap.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace atrium::world_server {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kClosed_rad = 5.0 * kDegree;  // a limit this near to the start closes
constexpr double kOpen_rad = 20.0 * kDegree;   // and the other one opens at least so far
// Parts that pass through each other often overlap a little, also where the hinge is right.
constexpr double kMoreOverlap_m = 0.05;
constexpr double kFree_m = 0.02;
constexpr std::array kShares{0.25, 0.5, 0.75, 1.0};  // of the way

// The direction in which a hinge opens, as a sign; 0: both, or neither.
double opens_towards(const std::array<double, 2>& limits) {
    if (-limits[0] <= kClosed_rad && limits[1] >= kOpen_rad) return 1.0;
    if (limits[1] <= kClosed_rad && -limits[0] >= kOpen_rad) return -1.0;
    return 0.0;
}

physics::RigidObject turned(const physics::RigidObject& object,
                            const physics::Joint& hinge,
                            double angle_rad) {
    physics::RigidObject after = object;
    const geometry::RigidTransform turn{
        Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, hinge.axis.normalized())),
        Eigen::Vector3d::Zero()};
    const geometry::RigidTransform to_anchor{Eigen::Quaterniond::Identity(), -hinge.anchor_m};
    after.world_from_object = to_anchor.inverse() * turn * to_anchor * object.world_from_object;
    return after;
}

}  // namespace

void doubt_hinges(const WorldDescription& world, std::vector<std::string>& lines) {
    for (const physics::Joint& joint : world.joints) {
        if (joint.kind != physics::JointKind::kHinge || joint.collides || !joint.limits) continue;
        const double direction = opens_towards(*joint.limits);
        const WorldObject* a = object_of(world, joint.a);
        const WorldObject* b = object_of(world, joint.b);
        if (direction == 0.0 || a == nullptr || b == nullptr) continue;
        const double reach_rad = direction > 0.0 ? (*joint.limits)[1] : -(*joint.limits)[0];
        const physics::RigidObject moving = to_rigid(*a), other = to_rigid(*b);
        if (moving.shape == physics::ObjectShape::kPlane) continue;
        const auto depth_at = [&](double angle_rad) {
            return physics::overlap_m(turned(moving, joint, angle_rad), other);
        };
        const double before_m = depth_at(0.0);
        double into_m = 0.0, at_rad = 0.0, back_m = 0.0;
        for (const double share : kShares) {
            const double angle_rad = direction * share * reach_rad;
            if (const double depth_m = depth_at(angle_rad); depth_m > into_m) {
                into_m = depth_m;
                at_rad = angle_rad;
            }
            back_m = std::max(back_m, depth_at(-angle_rad));
        }
        if (into_m < before_m + kMoreOverlap_m || back_m > before_m + kFree_m) continue;
        lines.push_back(
            fmt::format("joint_looks_wrong a={} b={} reason=\"at {:.0f} degrees {} is {:.2f} m "
                        "inside {}, and the other way it is free: reverse axis, or, if they shall "
                        "stop each other, write collide = true\"",
                        a->name,
                        b->name,
                        at_rad / kDegree,
                        a->name,
                        into_m,
                        b->name));
    }
}

}  // namespace atrium::world_server
