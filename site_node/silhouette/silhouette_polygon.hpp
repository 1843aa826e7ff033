#pragma once

#include <Eigen/Core>

#include <vector>

namespace atrium::silhouette {

/// Closed outline of one blob, or of a hole in one, in undistorted pixels (see
/// geometry::PinholeCamera).
struct SilhouettePolygon {
    std::vector<Eigen::Vector2d>
        vertices_px;       // foreground on the left, seen with +Y up; the first is not repeated
    bool is_hole = false;  // false: counter-clockwise (positive area); true: clockwise
};

}  // namespace atrium::silhouette
