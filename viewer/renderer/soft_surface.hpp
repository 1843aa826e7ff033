#pragma once

#include "viewer/renderer/shape_mesh.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace atrium::renderer {

/// A soft object: nodes that move, joined to triangles (seen from both sides) and segments.
struct SoftLook {
    std::uint32_t num_nodes = 0;
    std::vector<std::array<std::uint16_t, 3>> triangles = {};  // nodes, each below num_nodes
    std::vector<std::array<std::uint16_t, 2>> segments = {};
    double thickness_m = 0.02;                                // diameter of segments
    Eigen::Vector3d colour = Eigen::Vector3d::Constant(0.7);  // linear RGB in [0, 1]
    std::string texture = {};                                 // as ObjectLook has it
    /// Per node, as ShapeMesh has them; empty: none.
    std::vector<Eigen::Vector2f> texture_places = {};
};

/// Where a picture lies on the nodes: once across a cloth, whose nodes and triangles are rows of
/// squares from its left top; else once around the middle of the nodes, from top to bottom, as they
/// are now. `nodes_world`: as many as `look` has.
std::vector<Eigen::Vector2f> make_texture_places(const SoftLook& look,
                                                 std::span<const Eigen::Vector3f> nodes_world);

/// Triangles with smooth normals, and a tube of six sides along each segment. `nodes_world`: as
/// many as `look` has. Reuses the memory of `out`.
void make_soft_surface(const SoftLook& look,
                       std::span<const Eigen::Vector3f> nodes_world,
                       ShapeMesh& out);

}  // namespace atrium::renderer
