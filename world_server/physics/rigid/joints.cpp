#include "world_server/physics/rigid/joints.hpp"

#include "world_server/physics/rigid/object_body.hpp"

#include <btBulletDynamicsCommon.h>

#include <set>

namespace atrium::physics {
namespace {

constexpr btScalar kSleepMps = btScalar(0.2);
constexpr btScalar kSleepRadPerS = btScalar(3);

}  // namespace

Joints::~Joints() {
    for (const auto& joint : joints_) world_.removeConstraint(&joint->constraint());
}

void Joints::add(const Joint& joint, ObjectBody& a, ObjectBody* b) {
    joints_.push_back(std::make_unique<JointBody>(joint, a, b, tick_s_));
    world_.addConstraint(&joints_.back()->constraint(),
                         /*disableCollisionsBetweenLinkedBodies=*/!joint.collides);
    for (ObjectBody* object : {&a, b}) {
        if (object == nullptr) continue;
        // continuous collision stops a fast body in mid-tick, which would tear the joint
        object->body().setCcdMotionThreshold(0);
        // a heap of jointed bodies on the floor twitches: a puppet's foot now and then turns at 2
        // rad/s, which would keep everything awake
        object->body().setSleepingThresholds(kSleepMps, kSleepRadPerS);
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
