#include "world_server/physics/soft/soft_sample.hpp"

#include "world_server/physics/rigid/bullet_types.hpp"

#include <BulletSoftBody/btSoftBody.h>

namespace atrium::physics {

std::optional<btVector3> outward_at(const SoftSkin& skin, std::size_t i) {
    if (skin.outward.empty()) return std::nullopt;
    const SoftSample& sample = skin.samples[i];
    btVector3 out(0, 0, 0);
    for (int k = 0; k < 3; ++k) out += sample.weights[k] * skin.outward[sample.nodes[k]];
    return out;
}

SampleMotion motion_of(const btSoftBody& soft, const SoftSample& sample) {
    SampleMotion m{btVector3(0, 0, 0), btVector3(0, 0, 0), 0};
    for (int i = 0; i < 3; ++i) {
        const btSoftBody::Node& node = soft.m_nodes[static_cast<int>(sample.nodes[i])];
        const btScalar w = sample.weights[i];
        m.position += w * node.m_x;
        m.velocity += w * node.m_v;
        m.inverse_mass += w * w * node.m_im;
    }
    return m;
}

void move(btSoftBody& soft, const SoftSample& sample, const btVector3& impulse) {
    for (int i = 0; i < 3; ++i) {
        btSoftBody::Node& node = soft.m_nodes[static_cast<int>(sample.nodes[i])];
        node.m_x += impulse * (node.m_im * sample.weights[i]);
    }
}

Eigen::Vector3d centre_of(const btSoftBody& soft) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int i = 0; i < soft.m_nodes.size(); ++i) sum += from_bullet(soft.m_nodes[i].m_x);
    return sum / soft.m_nodes.size();
}

}  // namespace atrium::physics
