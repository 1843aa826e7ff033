#pragma once

#include <Eigen/Core>

#include <limits>

namespace atrium::geometry {

/// Axis-aligned box [m]; empty until a point is added.
struct Aabb {
    Eigen::Vector3d min = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector3d max = Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity());

    bool empty() const { return (min.array() > max.array()).any(); }
    void add(const Eigen::Vector3d& p) {
        min = min.cwiseMin(p);
        max = max.cwiseMax(p);
    }
    bool contains(const Eigen::Vector3d& p) const {
        return (p.array() >= min.array()).all() && (p.array() <= max.array()).all();
    }
    Eigen::Vector3d centre() const { return 0.5 * (min + max); }
    Eigen::Vector3d size() const { return max - min; }
};

}  // namespace atrium::geometry
