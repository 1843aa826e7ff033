#pragma once

#include "world_server/physics/soft/soft_object.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace atrium::physics {

/// A distance constraint between two nodes.
struct SoftLink {
    std::array<std::uint32_t, 2> nodes;
    bool bends = false;  // weak; only resists bending
};

/// A soft object at rest, in its own frame: nodes and links.
struct SoftMesh {
    std::vector<Eigen::Vector3d> nodes;  // [m]
    /// [m] where they start, in its own frame. A cloth is not quite flat then: a flat one that is
    /// held along its side would stand out like a board, because nothing begins to fold it.
    std::vector<Eigen::Vector3d> starts;
    std::vector<double> shares;   // share of the mass per node; they add up to 1
    std::vector<SoftLink> links;  // bending links come last
    SoftTopology topology;
};

/// Returns the number of nodes that `make_soft_mesh` would create.
std::size_t count_soft_nodes(const SoftObject& object);

/// Creates the nodes and links. `find_problem(object)` must be empty. Deterministic.
SoftMesh make_soft_mesh(const SoftObject& object);

/// Where a node starts [m], in the world.
Eigen::Vector3d start_of_node(const SoftObject& object, const SoftMesh& mesh, std::size_t node);

/// Returns the nodes of a pin as ascending indices into `mesh.nodes`.
std::vector<std::uint32_t> nodes_at(const SoftMesh& mesh,
                                    const SoftObject& object,
                                    const SoftPin& pin);

}  // namespace atrium::physics
