#pragma once

#include "core/geometry/aabb.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace atrium::geometry {

/// Indexed triangles, counter-clockwise seen from outside.
struct TriangleMesh {
    std::vector<Eigen::Vector3d> vertices;                // [m]
    std::vector<std::array<std::uint32_t, 3>> triangles;  // indices into `vertices`

    void clear() {
        vertices.clear();
        triangles.clear();
    }
    bool empty() const { return triangles.empty(); }
};

/// Topology and volume of a mesh. Topology is that of the indices; positions are not compared.
struct MeshReport {
    bool closed = false;  // every half-edge has exactly one twin in the opposite direction
    /// Closed, the triangles around every vertex form one cycle, and no vertex is unused.
    bool manifold = false;
    std::size_t num_components = 0;  // connected by shared edges
    std::int64_t euler_characteristic = 0;
    double volume_m3 = 0.0;  // signed; positive when oriented outwards
};

/// Determines topology and volume. If a triangle has invalid or repeated indices, only the volume
/// is set.
MeshReport inspect(const TriangleMesh& mesh);

/// Signed volume [m3]; positive if oriented outwards. Ignores triangles with invalid indices.
double volume_m3(const TriangleMesh& mesh);
Aabb bounds(const TriangleMesh& mesh);

/// Adds the vertices and triangles of `part` to `mesh`.
void append(TriangleMesh& mesh, const TriangleMesh& part);

/// Computes unit normals for display, one per vertex: the mean of the triangles' normals, weighted
/// by their angles at the vertex (Thürmer, Wüthrich, "Computing Vertex Normals from Polygonal
/// Facets", 1998). Zero if the vertex has no triangle with area.
///
/// The angles of a planar face have the same sum for every triangulation. Thin triangles and large
/// neighbours thus do not distort the shading, as with weights by area. Triangles so thin that
/// rounding determines their normal are left out.
std::vector<Eigen::Vector3f> vertex_normals(const TriangleMesh& mesh);

}  // namespace atrium::geometry
