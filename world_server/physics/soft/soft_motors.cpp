#include "world_server/physics/soft/soft_motors.hpp"

#include <BulletSoftBody/btSoftBody.h>

#include <cmath>

namespace atrium::physics {
namespace {

const btSoftBody::Node& node_at(const btSoftBody& soft, std::uint32_t i) {
    return soft.m_nodes[static_cast<int>(i)];
}

}  // namespace

SoftHandle handle_at(const btSoftBody& soft, const btVector3& point, btScalar hand_m) {
    SoftHandle handle;
    btScalar sum = 0;
    int nearest = -1;
    btScalar nearest_sq = 0;
    for (int i = 0; i < soft.m_nodes.size(); ++i) {
        const btSoftBody::Node& node = soft.m_nodes[i];
        if (!(node.m_im > 0)) continue;
        const btScalar distance_sq = (node.m_x - point).length2();
        if (nearest < 0 || distance_sq < nearest_sq) {
            nearest = i;
            nearest_sq = distance_sq;
        }
        const btScalar weight = 1 - distance_sq / (hand_m * hand_m);
        if (weight <= 0) continue;
        handle.nodes.push_back(static_cast<std::uint32_t>(i));
        handle.weights.push_back(weight);
        sum += weight;
    }
    if (nearest < 0) return handle;
    if (handle.nodes.empty()) {
        handle.nodes = {static_cast<std::uint32_t>(nearest)};
        handle.weights = {sum = 1};
    }
    for (btScalar& weight : handle.weights) weight /= sum;
    handle.offset = point - place_of(soft, handle);
    return handle;
}

btVector3 place_of(const btSoftBody& soft, const SoftHandle& handle) {
    btVector3 place = handle.offset;
    for (std::size_t i = 0; i < handle.nodes.size(); ++i)
        place += handle.weights[i] * node_at(soft, handle.nodes[i]).m_x;
    return place;
}

void SoftMotors::add(const SoftHandle& handle, const btVector3& velocity, btScalar max_force_n) {
    motors_.push_back({handle, velocity, max_force_n});
}

void SoftMotors::begin_tick(const btSoftBody& soft) {
    for (Motor& motor : motors_) motor.start = place_of(soft, motor.handle);
}

void SoftMotors::begin_substep() {
    for (Motor& motor : motors_) motor.given.setZero();
}

void SoftMotors::solve(btSoftBody& soft, btScalar substep_s, btScalar done_s) {
    for (Motor& motor : motors_) {
        const SoftHandle& handle = motor.handle;
        btScalar inverse_mass = 0;
        for (std::size_t i = 0; i < handle.nodes.size(); ++i) {
            inverse_mass +=
                handle.weights[i] * handle.weights[i] * node_at(soft, handle.nodes[i]).m_im;
        }
        if (!(inverse_mass > 0)) continue;
        const btVector3 missing = motor.start + motor.velocity * done_s - place_of(soft, handle);
        // bounds the sum over all iterations of a substep by the force
        btVector3 given = motor.given + missing / inverse_mass;
        const btScalar most = motor.max_force_n * substep_s * substep_s;
        const btScalar size = given.length();
        if (size > most) given *= most / size;
        const btVector3 impulse = given - motor.given;
        motor.given = given;
        for (std::size_t i = 0; i < handle.nodes.size(); ++i) {
            btSoftBody::Node& node = soft.m_nodes[static_cast<int>(handle.nodes[i])];
            node.m_x += impulse * (handle.weights[i] * node.m_im);
        }
    }
}

void SoftMotors::damp_swing(btSoftBody& soft, btScalar tick_s, btScalar damping_hz) const {
    const btScalar lost = 1 - std::exp(-damping_hz * tick_s);
    for (const Motor& motor : motors_) {
        btVector3 velocity(0, 0, 0);
        for (std::size_t i = 0; i < motor.handle.nodes.size(); ++i)
            velocity += motor.handle.weights[i] * node_at(soft, motor.handle.nodes[i]).m_v;
        for (int i = 0; i < soft.m_nodes.size(); ++i) {
            btSoftBody::Node& node = soft.m_nodes[i];
            if (node.m_im > 0) node.m_v += lost * (velocity - node.m_v);
        }
    }
}

}  // namespace atrium::physics
