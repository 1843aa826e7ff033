#include "world_server/description/joint_motion.hpp"

#include <Eigen/Geometry>

#include <limits>

namespace atrium::world_server {

std::optional<JointMotion> motion_of(const physics::Joint& joint, const WorldDescription& world) {
    if (joint.kind != physics::JointKind::kHinge && joint.kind != physics::JointKind::kSlider)
        return std::nullopt;
    const WorldObject* a = object_of(world, joint.a);
    const WorldObject* b = object_of(world, joint.b);
    if (a != nullptr && a->rigid.mass_kg != 0.0) return JointMotion{a, b, 1.0};
    if (a != nullptr && b != nullptr && b->rigid.mass_kg != 0.0) return JointMotion{b, a, -1.0};
    return std::nullopt;
}

double reach(const physics::Joint& joint, double direction) {
    if (!joint.limits) return std::numeric_limits<double>::infinity();
    return direction > 0.0 ? joint.limits->at(1) : -joint.limits->at(0);
}

geometry::RigidTransform pose_at(double way,
                                 const physics::Joint& joint,
                                 const JointMotion& motion) {
    const Eigen::Vector3d axis = joint.axis.normalized();
    const double moved = motion.sign * way;
    geometry::RigidTransform step;
    if (joint.kind == physics::JointKind::kSlider) {
        step.translation = moved * axis;
    } else {
        step.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(moved, axis));
        step.translation = joint.anchor_m - step.rotation * joint.anchor_m;
    }
    return step * motion.moving->rigid.world_from_object;
}

}  // namespace atrium::world_server
