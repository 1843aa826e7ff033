#include "world_server/physics/state_transfer.hpp"

#include "world_server/physics/rigid/object_body.hpp"

#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>

namespace atrium::physics {
namespace {

Eigen::Vector3f to_eigen(const btVector3& v) { return {float(v.x()), float(v.y()), float(v.z())}; }
btVector3 to_btv(const Eigen::Vector3f& v) {
    return btVector3(btScalar(v.x()), btScalar(v.y()), btScalar(v.z()));
}

}  // namespace

ObjectMotion motion_of(ObjectBody& object) {
    const btRigidBody& body = object.body();
    const btTransform& transform = body.getWorldTransform();
    ObjectMotion motion;
    motion.id = object.object().id;
    motion.position_m = to_eigen(transform.getOrigin());
    for (int r = 0; r < 3; ++r) {
        motion.rotation.row(r) = to_eigen(transform.getBasis()[r]).transpose();
    }
    motion.linear_velocity = to_eigen(body.getLinearVelocity());
    motion.angular_velocity = to_eigen(body.getAngularVelocity());
    motion.activation = body.getActivationState();
    motion.idle_s = float(body.getDeactivationTime());
    return motion;
}

void set_motion(const ObjectMotion& motion, ObjectBody& object) {
    object.reset_to_start();  // clears forces and interpolation state
    btRigidBody& body = object.body();
    btTransform transform;
    transform.setOrigin(to_btv(motion.position_m));
    const Eigen::Matrix3f& m = motion.rotation;
    transform.setBasis(btMatrix3x3(
        m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2)));
    body.setLinearVelocity(to_btv(motion.linear_velocity));
    body.setAngularVelocity(to_btv(motion.angular_velocity));
    body.setCenterOfMassTransform(transform);
    body.setInterpolationWorldTransform(transform);
    body.forceActivationState(motion.activation);
    body.setDeactivationTime(btScalar(motion.idle_s));
}

void forget_history(btSoftRigidDynamicsWorld& world, const std::vector<btRigidBody*>& bodies) {
    struct Member {
        btCollisionObject* object;
        int group;
        int mask;
        int activation;
        btScalar idle_s;
        std::pair<std::size_t, int> place;  // position in the order of re-adding
    };
    std::vector<Member> members;
    for (int i = 0; i < world.getNumCollisionObjects(); ++i) {
        btCollisionObject* object = world.getCollisionObjectArray()[i];
        const btBroadphaseProxy& proxy = *object->getBroadphaseHandle();
        // bodies outside the list keep their order: proxy ids ascend
        const auto found = std::find(bodies.begin(), bodies.end(), object);
        const std::size_t place =
            found == bodies.end() ? 0 : 1 + static_cast<std::size_t>(found - bodies.begin());
        members.push_back({object,
                           proxy.m_collisionFilterGroup,
                           proxy.m_collisionFilterMask,
                           object->getActivationState(),
                           object->getDeactivationTime(),
                           {place, proxy.m_uniqueId}});
    }
    std::sort(members.begin(), members.end(), [](const Member& a, const Member& b) {
        return a.place < b.place;
    });
    for (const Member& member : members) world.removeCollisionObject(member.object);
    world.getBroadphase()->resetPool(world.getDispatcher());
    world.getConstraintSolver()->reset();
    for (const Member& member : members) {
        if (auto* body = btRigidBody::upcast(member.object))
            world.addRigidBody(body, member.group, member.mask);
        else if (auto* soft = btSoftBody::upcast(member.object))
            world.addSoftBody(soft, member.group, member.mask);
        else
            world.addCollisionObject(member.object, member.group, member.mask);
        member.object->forceActivationState(member.activation);
        member.object->setDeactivationTime(member.idle_s);
    }
}

}  // namespace atrium::physics
