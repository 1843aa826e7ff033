#include "world_server/physics/rigid/joints.hpp"

#include "world_server/physics/rigid/object_body.hpp"

#include <btBulletDynamicsCommon.h>

#include <set>

namespace atrium::physics {

Joints::~Joints() {
    for (const auto& joint : joints_) world_.removeConstraint(&joint->constraint());
}

void Joints::add(const Joint& joint, ObjectBody& a, ObjectBody* b) {
    joints_.push_back(std::make_unique<JointBody>(joint, a, b, tick_s_));
    btTypedConstraint& constraint = joints_.back()->constraint();
    constraint.setOverrideNumSolverIterations(options_.num_iterations);
    world_.addConstraint(&constraint,
                         /*disableCollisionsBetweenLinkedBodies=*/!joint.collides);
    for (ObjectBody* object : {&a, b}) {
        if (object == nullptr) continue;
        // continuous collision stops a fast body in mid-tick, which would tear the joint
        object->body().setCcdMotionThreshold(0);
        object->body().setSleepingThresholds(options_.sleep_mps, options_.sleep_rad_s);
    }
}

void Joints::remove_of(std::uint32_t object) {
    std::erase_if(joints_, [&](const std::unique_ptr<JointBody>& joint) {
        if (joint->joint().a != object && joint->joint().b != object) return false;
        btTypedConstraint& constraint = joint->constraint();
        constraint.getRigidBodyA().activate();
        constraint.getRigidBodyB().activate();
        world_.removeConstraint(&constraint);
        return true;
    });
}

void Joints::begin_tick() {
    for (const auto& joint : joints_) joint->begin_tick();
}

std::vector<std::uint32_t> Joints::group_of(std::uint32_t object) const {
    std::set<std::uint32_t> group{object};
    for (std::size_t before = 0; before != group.size();) {
        before = group.size();
        for (const auto& joint : joints_) {
            const Joint& j = joint->joint();
            if (j.b == 0 || (!group.contains(j.a) && !group.contains(j.b))) continue;
            group.insert({j.a, j.b});
        }
    }
    return {group.begin(), group.end()};
}

}  // namespace atrium::physics
