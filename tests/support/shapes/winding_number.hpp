#pragma once

#include "core/geometry/triangle_mesh.hpp"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace atrium::test {

/// Computes the winding number of `mesh` around `p` from solid angles (van Oosterom, Strackee
/// 1983): 1 inside, 0 outside a closed mesh. O(triangles).
inline double winding_number(const geometry::TriangleMesh& mesh, const Eigen::Vector3d& p) {
    double solid_angle = 0.0;
    for (const auto& [ia, ib, ic] : mesh.triangles) {
        const Eigen::Vector3d a = mesh.vertices[ia] - p;
        const Eigen::Vector3d b = mesh.vertices[ib] - p;
        const Eigen::Vector3d c = mesh.vertices[ic] - p;
        const double la = a.norm();
        const double lb = b.norm();
        const double lc = c.norm();
        const double numerator = a.dot(b.cross(c));
        const double denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        solid_angle += 2.0 * std::atan2(numerator, denominator);
    }
    return solid_angle / (4.0 * std::numbers::pi);
}

}  // namespace atrium::test
