#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <limits>
#include <vector>

namespace atrium::test {

using Contour = std::vector<Eigen::Vector2d>;  // closed, first point not repeated
using Contours = std::vector<Contour>;

template <typename Visit>
void for_each_segment(const Contours& contours, const Visit& visit) {
    for (const Contour& contour : contours) {
        for (std::size_t i = 0; i < contour.size(); ++i)
            visit(contour[i], contour[(i + 1) % contour.size()]);
    }
}

/// Independent of the hull's own test.
inline bool even_odd(const Contours& contours, const Eigen::Vector2d& p) {
    bool inside = false;
    for_each_segment(contours, [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
        if ((a.y() > p.y()) == (b.y() > p.y())) return;
        if (a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()) > p.x()) inside = !inside;
    });
    return inside;
}

/// Infinite without segments.
inline double distance_to_edges(const Contours& contours, const Eigen::Vector2d& p) {
    double least = std::numeric_limits<double>::infinity();
    for_each_segment(contours, [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
        const Eigen::Vector2d along = b - a;
        const double length2 = along.squaredNorm();
        const double t = length2 > 0.0 ? std::clamp(along.dot(p - a) / length2, 0.0, 1.0) : 0.0;
        least = std::min(least, (p - a - t * along).norm());
    });
    return least;
}

}  // namespace atrium::test
