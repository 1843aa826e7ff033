#pragma once

#include "core/geometry/triangle_mesh.hpp"

#include <Eigen/Core>

namespace atrium::test {

/// A closed box of twelve triangles, with its lowest corner at `min`.
inline geometry::TriangleMesh box_mesh(const Eigen::Vector3d& min, const Eigen::Vector3d& size) {
    geometry::TriangleMesh mesh;
    for (int i = 0; i < 8; ++i) {
        mesh.vertices.push_back(min +
                                size.cwiseProduct(Eigen::Vector3d(i & 1, (i >> 1) & 1, i >> 2)));
    }
    mesh.triangles = {{0, 2, 1},
                      {1, 2, 3},
                      {4, 5, 6},
                      {5, 7, 6},
                      {0, 1, 4},
                      {1, 5, 4},
                      {2, 6, 3},
                      {3, 6, 7},
                      {0, 4, 2},
                      {2, 4, 6},
                      {1, 3, 5},
                      {3, 7, 5}};
    return mesh;
}

}  // namespace atrium::test
