#pragma once

#include <Eigen/Core>

#include <vector>

namespace atrium::silhouette {

/// Closed outline of a blob or of a hole in one, in undistorted pixels (see
/// geometry::PinholeCamera).
struct SilhouettePolygon {
    /// Foreground on the left, with +Y up; the first vertex is not repeated.
    std::vector<Eigen::Vector2d> vertices_px;
    bool is_hole = false;  // false: counter-clockwise (positive area); true: clockwise
};

}  // namespace atrium::silhouette
