#pragma once

#include "core/geometry/aabb.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace atrium::geometry {

/// Indexed triangles; counter-clockwise seen from outside.
struct TriangleMesh {
    std::vector<Eigen::Vector3d> vertices;                // [m]
    std::vector<std::array<std::uint32_t, 3>> triangles;  // indices into `vertices`

    void clear() {
        vertices.clear();
        triangles.clear();
    }
    bool empty() const { return triangles.empty(); }
};

/// What `inspect` found. All counts are of the mesh as indexed; positions are never compared.
struct MeshReport {
    bool closed = false;  // every half-edge has exactly one twin in the opposite direction
    bool manifold =
        false;  // closed, and the triangles around every vertex form one cycle; no unused vertices
    std::size_t num_components = 0;  // connected by shared edges
    std::int64_t euler_characteristic = 0;
    double volume_m3 = 0.0;  // signed; positive when oriented outwards
};

MeshReport inspect(const TriangleMesh& mesh);

double volume_m3(const TriangleMesh& mesh);
Aabb bounds(const TriangleMesh& mesh);

/// Unit normals for display, one per vertex: the mean of the triangles' normals by their angles at
/// the vertex (Thürmer, Wüthrich, "Computing Vertex Normals from Polygonal Facets", 1998); zero
/// where a vertex has no triangle with area.
///
/// Angles of a planar face add up to the same however it is cut into triangles, so thin triangles
/// and large neighbours do not bend the shading, as they do when areas are the weights. Triangles
/// so thin that rounding decides where they face are left out.
std::vector<Eigen::Vector3f> vertex_normals(const TriangleMesh& mesh);

/// Winding number of `mesh` around `p`, by solid angles (van Oosterom, Strackee 1983): 1 inside, 0
/// outside a closed mesh. O(triangles).
double winding_number(const TriangleMesh& mesh, const Eigen::Vector3d& p);

}  // namespace atrium::geometry
