#include "world_server/physics/soft_ties.hpp"

#include <BulletSoftBody/btSoftBody.h>
#include <LinearMath/btTransformUtil.h>

#include <algorithm>

namespace atrium::physics {

void TiedBodies::add(btRigidBody& body) {
    const auto is_same = [&](const Body& known) { return known.body == &body; };
    if (body.getInvMass() == 0 || std::any_of(bodies_.begin(), bodies_.end(), is_same)) return;
    const btVector3 none(0, 0, 0);
    bodies_.push_back({&body, body.getLinearVelocity(), body.getAngularVelocity(), none, none});
}

void TiedBodies::end_substep(btScalar substep_s) {
    for (Body& b : bodies_) {
        b.moved += (b.body->getLinearVelocity() - b.velocity) * substep_s;
        b.turned += (b.body->getAngularVelocity() - b.spin) * substep_s;
    }
}

void TiedBodies::end_tick() {
    for (const Body& b : bodies_) {
        btTransform before = b.body->getWorldTransform();
        btTransform after;
        btTransformUtil::integrateTransform(before, b.moved, b.turned, 1, after);
        b.body->setWorldTransform(after);
        b.body->setInterpolationWorldTransform(after);
        b.body->updateInertiaTensor();
    }
}

void SoftTies::tie(const btSoftBody& soft, std::uint32_t node, btRigidBody& body) {
    Tie tie;
    tie.node = node;
    tie.body = &body;
    tie.place = body.getWorldTransform().invXform(soft.m_nodes[static_cast<int>(node)].m_x);
    ties_.push_back(tie);
}

void SoftTies::untie(const btRigidBody& body) {
    std::erase_if(ties_, [&](const Tie& tie) { return tie.body == &body; });
}

bool SoftTies::hold(const btRigidBody& body) const {
    return std::any_of(
        ties_.begin(), ties_.end(), [&](const Tie& tie) { return tie.body == &body; });
}

void SoftTies::begin_tick(TiedBodies& bodies) {
    for (Tie& tie : ties_) {
        bodies.add(*tie.body);
        const btVector3 arm = tie.body->getWorldTransform().getBasis() * tie.place;
        tie.velocity = tie.body->getVelocityInLocalPoint(arm);
        tie.shift.setZero();
    }
}

void SoftTies::solve(btSoftBody& soft, btScalar substep_s, btScalar left_s) {
    for (Tie& tie : ties_) {
        btSoftBody::Node& node = soft.m_nodes[static_cast<int>(tie.node)];
        const btTransform& pose = tie.body->getWorldTransform();
        const btVector3 arm = pose.getBasis() * tie.place;
        const btVector3 gained = tie.body->getVelocityInLocalPoint(arm) - tie.velocity;
        const btVector3 place =
            pose.getOrigin() + arm - tie.velocity * left_s + tie.shift + gained * substep_s;
        // motion of node and place against each other per impulse
        const btScalar share = node.m_im + tie.body->getInvMass();
        btMatrix3x3 cross;
        arm.getSkewSymmetricMatrix(&cross[0], &cross[1], &cross[2]);
        btMatrix3x3 apart = cross * tie.body->getInvInertiaTensorWorld() * cross;
        apart = btMatrix3x3(share, 0, 0, 0, share, 0, 0, 0, share) - apart;
        const btScalar determinant = apart.determinant();
        if (!(determinant > 0)) continue;
        const btVector3 impulse = apart.inverse() * (place - node.m_x);
        node.m_x += impulse * node.m_im;
        if (tie.body->getInvMass() > 0) {
            tie.body->applyImpulse(-impulse / substep_s, arm);
            tie.body->activate();
        }
    }
}

void SoftTies::end_substep(btScalar substep_s) {
    for (Tie& tie : ties_) {
        const btVector3 arm = tie.body->getWorldTransform().getBasis() * tie.place;
        tie.shift += (tie.body->getVelocityInLocalPoint(arm) - tie.velocity) * substep_s;
    }
}

void SoftTies::limit(std::span<const std::uint8_t> marks, btScalar most_mps) {
    for (const Tie& tie : ties_) {
        if (marks[tie.node] == 0) continue;
        const btScalar most = std::max(most_mps, tie.velocity.length());
        const btScalar speed = tie.body->getLinearVelocity().length();
        if (speed > most)
            tie.body->setLinearVelocity(tie.body->getLinearVelocity() * (most / speed));
    }
}

}  // namespace atrium::physics
