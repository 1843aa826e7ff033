#include "world_server/physics/soft/soft_volume.hpp"

#include <BulletSoftBody/btSoftBody.h>

#include <algorithm>
#include <cmath>

namespace atrium::physics {
namespace {

btScalar limited(btScalar v, btScalar limit) { return std::clamp(v, -limit, limit); }

}  // namespace

SoftVolume::SoftVolume(btSoftBody& body,
                       const SoftTopology& topology,
                       btScalar match_share,
                       const SoftVolumeOptions& options)
    : body_(body), topology_(topology), match_share_(match_share), options_(options) {
    body_.setPose(/*bvolume=*/false, /*bframe=*/true);
    gradients_.assign(static_cast<std::size_t>(body_.m_nodes.size()), btVector3(0, 0, 0));
    rest_volume_ = find_gradients() / 6;
    // the gradient of the volume points along the normal
    rest_outward_ = gradients_;
    for (btVector3& out : rest_outward_) {
        if (out.length2() > 0) out.normalize();
    }
    outward_ = rest_outward_;
    const btVector3 extents = body_.m_bounds[1] - body_.m_bounds[0];
    inner_radius_ = btScalar(0.5) * extents[extents.minAxis()];
}

void SoftVolume::begin_tick() {
    body_.updatePose();
    for (std::size_t i = 0; i < outward_.size(); ++i) {
        outward_[i] = body_.m_pose.m_rot * rest_outward_[i];
    }
}

// Moves each node a share of the way to its place in the rest shape, which is first fitted to the
// nodes (Müller et al., "Meshless Deformations Based on Shape Matching", 2005). The share grows
// with the distance. Otherwise a few nodes pushed by a fist would pass through the whole body
// before it moves.
void SoftVolume::match_shape(btScalar part) {
    body_.updatePose();
    const btSoftBody::Pose& pose = body_.m_pose;
    const SoftVolumeOptions options = options_;
    btVector3 moved(0, 0, 0);  // [kg m]
    btScalar mass = 0;
    for (int i = 0; i < body_.m_nodes.size(); ++i) {
        btSoftBody::Node& node = body_.m_nodes[i];
        if (!(node.m_im > 0)) continue;
        const btVector3 way = pose.m_com + pose.m_rot * pose.m_pos[i] - node.m_x;
        const btScalar out =
            (way.length() / inner_radius_ - options.dent_start) / options.dent_range;
        const btScalar over = std::clamp(out, btScalar(0), btScalar(1));
        const btVector3 step =
            way * (share_ * part * part *
                   (match_share_ + (options.dent_share - match_share_) * over * over));
        node.m_x += step;
        moved += step / node.m_im;
        mass += 1 / node.m_im;
    }
    // unequal shares shift the centre of mass: undo the shift
    const btVector3 back = moved / mass;
    for (int i = 0; i < body_.m_nodes.size(); ++i) {
        btSoftBody::Node& node = body_.m_nodes[i];
        if (node.m_im > 0) node.m_x -= back;
    }
}

// Computes six times the volume and six times its gradient with respect to each node.
btScalar SoftVolume::find_gradients() {
    std::fill(gradients_.begin(), gradients_.end(), btVector3(0, 0, 0));
    const btVector3 origin = body_.m_pose.m_com;
    btScalar volume = 0;
    for (const auto& t : topology_.triangles) {
        const btVector3 a = body_.m_nodes[static_cast<int>(t[0])].m_x - origin;
        const btVector3 b = body_.m_nodes[static_cast<int>(t[1])].m_x - origin;
        const btVector3 c = body_.m_nodes[static_cast<int>(t[2])].m_x - origin;
        const btVector3 bc = b.cross(c);
        volume += a.dot(bc);
        gradients_[t[0]] += bc;
        gradients_[t[1]] += c.cross(a);
        gradients_[t[2]] += a.cross(b);
    }
    return volume;
}

// Moves the nodes along the gradient of the volume, in proportion to their inverse mass.
void SoftVolume::keep_volume() {
    const btScalar volume = find_gradients();
    btScalar weight = 0;
    for (int i = 0; i < body_.m_nodes.size(); ++i) {
        weight += body_.m_nodes[i].m_im * gradients_[static_cast<std::size_t>(i)].length2();
    }
    if (!(weight > 0)) return;
    const btScalar missing =
        limited(6 * rest_volume_ - volume, 6 * options_.max_volume_step * rest_volume_);
    const btScalar push = share_ * missing / weight;
    for (int i = 0; i < body_.m_nodes.size(); ++i) {
        btSoftBody::Node& node = body_.m_nodes[i];
        node.m_x += gradients_[static_cast<std::size_t>(i)] * (push * node.m_im);
    }
}

// Damps motion that is not rigid. Linear and angular motion of the whole stay.
void SoftVolume::damp_inside(btScalar seconds) {
    btVector3 centre(0, 0, 0), momentum(0, 0, 0), spin(0, 0, 0);
    btScalar mass = 0;
    for (int i = 0; i < body_.m_nodes.size(); ++i) {
        const btSoftBody::Node& node = body_.m_nodes[i];
        if (!(node.m_im > 0)) return;  // a pinned body does not move freely
        mass += 1 / node.m_im;
        centre += node.m_x / node.m_im;
        momentum += node.m_v / node.m_im;
    }
    centre /= mass;
    const btVector3 velocity = momentum / mass;
    btMatrix3x3 inertia(0, 0, 0, 0, 0, 0, 0, 0, 0);
    for (int i = 0; i < body_.m_nodes.size(); ++i) {
        const btSoftBody::Node& node = body_.m_nodes[i];
        const btVector3 arm = node.m_x - centre;
        spin += arm.cross(node.m_v - velocity) / node.m_im;
        btMatrix3x3 cross;
        arm.getSkewSymmetricMatrix(&cross[0], &cross[1], &cross[2]);
        inertia -= (cross * cross) * (1 / node.m_im);
    }
    if (!(inertia.determinant() > 0)) return;
    const btVector3 turn = inertia.inverse() * spin;
    const btScalar lost = 1 - std::exp(-options_.inner_damping_hz * seconds);
    for (int i = 0; i < body_.m_nodes.size(); ++i) {
        btSoftBody::Node& node = body_.m_nodes[i];
        node.m_v += lost * (velocity + turn.cross(node.m_x - centre) - node.m_v);
    }
}

}  // namespace atrium::physics
