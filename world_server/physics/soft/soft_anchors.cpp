#include "world_server/physics/soft/soft_anchors.hpp"

#include <BulletSoftBody/btSoftBody.h>
#include <LinearMath/btTransformUtil.h>

#include <algorithm>

namespace atrium::physics {

void AnchoredBodies::add(btRigidBody& body) {
    const auto is_same = [&](const Body& known) { return known.body == &body; };
    if (body.getInvMass() == 0 || std::any_of(bodies_.begin(), bodies_.end(), is_same)) return;
    const btVector3 none(0, 0, 0);
    bodies_.push_back({&body, body.getLinearVelocity(), body.getAngularVelocity(), none, none});
}

void AnchoredBodies::end_substep(btScalar substep_s) {
    for (Body& b : bodies_) {
        b.moved += (b.body->getLinearVelocity() - b.velocity) * substep_s;
        b.turned += (b.body->getAngularVelocity() - b.spin) * substep_s;
    }
}

void AnchoredBodies::end_tick() {
    for (const Body& b : bodies_) {
        btTransform before = b.body->getWorldTransform();
        btTransform after;
        btTransformUtil::integrateTransform(before, b.moved, b.turned, 1, after);
        b.body->setWorldTransform(after);
        b.body->setInterpolationWorldTransform(after);
        b.body->updateInertiaTensor();
    }
}

void SoftAnchors::attach(const btSoftBody& soft, std::uint32_t node, btRigidBody& body) {
    Anchor anchor;
    anchor.node = node;
    anchor.body = &body;
    anchor.place = body.getWorldTransform().invXform(soft.m_nodes[static_cast<int>(node)].m_x);
    anchors_.push_back(anchor);
}

void SoftAnchors::detach(const btRigidBody& body) {
    std::erase_if(anchors_, [&](const Anchor& anchor) { return anchor.body == &body; });
}

bool SoftAnchors::is_attached_to(const btRigidBody& body) const {
    return std::any_of(anchors_.begin(), anchors_.end(), [&](const Anchor& anchor) {
        return anchor.body == &body;
    });
}

void SoftAnchors::begin_tick(AnchoredBodies& bodies) {
    for (Anchor& anchor : anchors_) {
        bodies.add(*anchor.body);
        const btVector3 arm = anchor.body->getWorldTransform().getBasis() * anchor.place;
        anchor.velocity = anchor.body->getVelocityInLocalPoint(arm);
        anchor.shift.setZero();
    }
}

void SoftAnchors::solve(btSoftBody& soft, btScalar substep_s, btScalar left_s) {
    for (Anchor& anchor : anchors_) {
        btSoftBody::Node& node = soft.m_nodes[static_cast<int>(anchor.node)];
        const btTransform& pose = anchor.body->getWorldTransform();
        const btVector3 arm = pose.getBasis() * anchor.place;
        const btVector3 gained = anchor.body->getVelocityInLocalPoint(arm) - anchor.velocity;
        const btVector3 place =
            pose.getOrigin() + arm - anchor.velocity * left_s + anchor.shift + gained * substep_s;
        // motion of node and place against each other per impulse
        const btScalar inverse_mass = node.m_im + anchor.body->getInvMass();
        btMatrix3x3 cross;
        arm.getSkewSymmetricMatrix(&cross[0], &cross[1], &cross[2]);
        btMatrix3x3 apart = cross * anchor.body->getInvInertiaTensorWorld() * cross;
        apart = btMatrix3x3(inverse_mass, 0, 0, 0, inverse_mass, 0, 0, 0, inverse_mass) - apart;
        const btScalar determinant = apart.determinant();
        if (!(determinant > 0)) continue;
        const btVector3 impulse = apart.inverse() * (place - node.m_x);
        node.m_x += impulse * node.m_im;
        if (anchor.body->getInvMass() > 0) {
            anchor.body->applyImpulse(-impulse / substep_s, arm);
            anchor.body->activate();
        }
    }
}

void SoftAnchors::end_substep(btScalar substep_s) {
    for (Anchor& anchor : anchors_) {
        const btVector3 arm = anchor.body->getWorldTransform().getBasis() * anchor.place;
        anchor.shift += (anchor.body->getVelocityInLocalPoint(arm) - anchor.velocity) * substep_s;
    }
}

void SoftAnchors::limit(std::span<const std::uint8_t> marks, btScalar most_mps) {
    for (const Anchor& anchor : anchors_) {
        if (marks[anchor.node] == 0) continue;
        const btScalar most = std::max(most_mps, anchor.velocity.length());
        const btScalar speed = anchor.body->getLinearVelocity().length();
        if (speed > most)
            anchor.body->setLinearVelocity(anchor.body->getLinearVelocity() * (most / speed));
    }
}

}  // namespace atrium::physics
