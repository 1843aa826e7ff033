#pragma once

#include "core/geometry/triangle_mesh.hpp"

#include <Eigen/Core>

#include <vector>

namespace atrium::test {

/// Exact distances of points to a mesh's triangles. Shares no code with the makers of the meshes.
class SurfaceDistance {
public:
    explicit SurfaceDistance(const geometry::TriangleMesh& mesh);

    double distance_m(const Eigen::Vector3d& p) const;

    /// Largest distance of `from`'s vertices, edge middles, triangle middles and `num_random`
    /// points that are spread evenly over its area. The area must not be zero unless `num_random`
    /// is.
    double largest_m(const geometry::TriangleMesh& from, int num_random) const;

private:
    const geometry::TriangleMesh& mesh_;
    std::vector<Eigen::Vector3d> centres_;  // of a ball around each triangle
    std::vector<double> radii_m_;
};

}  // namespace atrium::test
