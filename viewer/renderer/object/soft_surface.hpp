#pragma once

#include "viewer/renderer/drawing/shape_mesh.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace atrium::renderer {

/// A soft object: moving nodes, joined to triangles (visible from both sides) and segments.
struct SoftLook {
    std::uint32_t num_nodes = 0;
    std::vector<std::array<std::uint16_t, 3>> triangles = {};  // node indices, each below num_nodes
    std::vector<std::array<std::uint16_t, 2>> segments = {};
    double thickness_m = 0.02;                                // diameter of the segments
    Eigen::Vector3d colour = Eigen::Vector3d::Constant(0.7);  // linear RGB in [0, 1]
    std::string texture = {};                                 // as in ObjectLook
    /// Texture coordinates per node, as in ShapeMesh. Empty: none.
    std::vector<Eigen::Vector2f> texture_places = {};
};

/// Computes texture coordinates of the nodes at `nodes_world`, as many as `look` has. A texture
/// covers a cloth once; nodes and triangles of a cloth are rows of squares from its top left.
/// Otherwise the texture wraps once around the centre of the nodes, from top to bottom.
std::vector<Eigen::Vector2f> make_texture_places(const SoftLook& look,
                                                 std::span<const Eigen::Vector3f> nodes_world);

/// Makes the surface: triangles with smooth normals, and a tube of six sides along each segment.
/// `nodes_world`: as many as `look` has. Reuses the memory of `out`.
void make_soft_surface(const SoftLook& look,
                       std::span<const Eigen::Vector3f> nodes_world,
                       ShapeMesh& out);

}  // namespace atrium::renderer
