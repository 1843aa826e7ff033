#pragma once

#include "core/geometry/triangle_mesh.hpp"
#include "tests/support/shapes/surface_distance.hpp"
#include "tests/support/shapes/winding_number.hpp"

#include <Eigen/Core>

namespace atrium::test {

/// Distance to the surface of a closed mesh, negative inside.
class SignedDistance {
public:
    explicit SignedDistance(const geometry::TriangleMesh& mesh) : mesh_(mesh), distance_(mesh) {}
    /// [m]
    double at(const Eigen::Vector3d& p) const {
        const double distance = distance_.distance_m(p);
        return winding_number(mesh_, p) > 0.5 ? -distance : distance;
    }
    /// Direction in which the distance grows, over a centimetre. The facets of a hull differ from
    /// the true surface.
    Eigen::Vector3d direction_out(const Eigen::Vector3d& p) const {
        Eigen::Vector3d slope;
        for (int axis = 0; axis < 3; ++axis) {
            const Eigen::Vector3d step = 0.005 * Eigen::Vector3d::Unit(axis);
            slope[axis] = at(p + step) - at(p - step);
        }
        return slope.normalized();
    }

private:
    const geometry::TriangleMesh& mesh_;
    SurfaceDistance distance_;
};

}  // namespace atrium::test
