#pragma once

#include "world_server/physics/soft_object.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace atrium::physics {

/// Two nodes that keep their distance.
struct SoftLink {
    std::array<std::uint32_t, 2> nodes;
    bool bends = false;  // resists bending only, and is weak
};

/// A soft object at rest, in its own frame, as nodes and what joins them.
struct SoftMesh {
    std::vector<Eigen::Vector3d> nodes;  // [m]
    std::vector<double> shares;          // of the mass, one per node; they add up to 1
    std::vector<SoftLink> links;         // those that bend last
    SoftTopology topology;
};

/// How many nodes `make_soft_mesh` would make.
std::size_t count_soft_nodes(const SoftObject& object);

/// `object` must have no problem. Deterministic.
SoftMesh make_soft_mesh(const SoftObject& object);

/// Indices into `mesh.nodes`, ascending.
std::vector<std::uint32_t> nodes_at(const SoftMesh& mesh,
                                    const SoftObject& object,
                                    const SoftPin& pin);

}  // namespace atrium::physics
