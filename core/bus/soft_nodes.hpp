#pragma once

#include "core/bus/messages.hpp"

#include <Eigen/Core>

#include <span>

/// Places of a soft object's nodes in 16 bits a coordinate: a cloth of 2 m is true to 0.02 mm.
namespace atrium::bus {

/// Sets `origin_m`, `step_m` and `nodes` of `out`; each node is off by half a step at most.
/// `places` are finite, in the world [m], at most kMaxSoftNodes.
void quantise(std::span<const Eigen::Vector3f> places, SoftBodyState& out);

/// [m] world.
inline Eigen::Vector3d node_place(const SoftBodyState& state, std::size_t node) {
    const auto& [x, y, z] = state.nodes[node];
    return state.origin_m + state.step_m * Eigen::Vector3d(x, y, z);
}

}  // namespace atrium::bus
