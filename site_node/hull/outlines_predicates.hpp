#pragma once

#include <Eigen/Core>

// Predicates that the outline files share, so all of them decide by the same formula.
namespace atrium::hull {

/// Points closer than this are one: far below the resolution of a picture, far above the jitter.
inline constexpr double kSamePoint_px = 1e-4;

inline bool less_yx(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.y() != b.y() ? a.y() < b.y() : a.x() < b.x();
}

inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
}

/// > 0: c lies left of a -> b, in axes with x right and y up
inline double side(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
    return cross(b - a, c - a);
}

inline bool segments_cross(const Eigen::Vector2d& a,
                           const Eigen::Vector2d& b,
                           const Eigen::Vector2d& c,
                           const Eigen::Vector2d& d) {
    return (side(a, b, c) > 0.0) != (side(a, b, d) > 0.0) &&
           (side(c, d, a) > 0.0) != (side(c, d, b) > 0.0);
}

/// Returns where a -> b crosses the line through c and d: 0 at a, 1 at b.
inline double crossing_parameter(const Eigen::Vector2d& a,
                                 const Eigen::Vector2d& b,
                                 const Eigen::Vector2d& c,
                                 const Eigen::Vector2d& d) {
    const double at_a = side(c, d, a);
    const double at_b = side(c, d, b);
    return at_a / (at_a - at_b);
}

}  // namespace atrium::hull
