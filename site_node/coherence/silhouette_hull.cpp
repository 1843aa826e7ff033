#include "site_node/coherence/silhouette_hull.hpp"

#include <algorithm>
#include <limits>

namespace atrium::coherence {
namespace {

double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

// Andrew's monotone chain; positive turns.
std::vector<Eigen::Vector2d> convex_hull(std::vector<Eigen::Vector2d> points) {
    std::ranges::sort(points, [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
        return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
    });
    if (points.size() < 3) return {};
    std::vector<Eigen::Vector2d> hull(2 * points.size());
    std::size_t n = 0;
    const auto add = [&](const Eigen::Vector2d& p, std::size_t first) {
        while (n >= first + 2 && turn(hull[n - 2], hull[n - 1], p) <= 0.0) --n;
        hull[n++] = p;
    };
    for (const Eigen::Vector2d& p : points) add(p, 0);
    const std::size_t upper = n - 1;
    for (auto p = points.rbegin() + 1; p != points.rend(); ++p) add(*p, upper);
    hull.resize(n - 1);  // the first point was added again
    return hull;
}

}  // namespace

SilhouetteHull hull_of(std::span<const std::vector<Eigen::Vector2d>> contours,
                       const geometry::PinholeCamera& camera,
                       double margin_px) {
    SilhouetteHull hull;
    hull.has_picture = true;
    std::vector<Eigen::Vector2d> points;
    for (const auto& contour : contours) {
        for (const Eigen::Vector2d& p : contour)
            if (p.allFinite()) points.push_back(p);
    }
    hull.points = convex_hull(std::move(points));
    if (hull.points.size() < 3) hull.points.clear();
    for (const Eigen::Vector2d& p : hull.points) {
        const Eigen::Vector2d px = camera.distort(p);
        const bool is_inside = px.x() > margin_px - 0.5 && px.y() > margin_px - 0.5 &&
                               px.x() < camera.width - 0.5 - margin_px &&
                               px.y() < camera.height - 0.5 - margin_px;
        hull.at_border.push_back(is_inside ? 0 : 1);
    }
    return hull;
}

double distance_outside_px(const SilhouetteHull& hull, const Eigen::Vector2d& px) {
    double farthest = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < hull.points.size(); ++i) {
        const Eigen::Vector2d& a = hull.points[i];
        const Eigen::Vector2d along = hull.points[(i + 1) % hull.points.size()] - a;
        const Eigen::Vector2d out(along.y(), -along.x());
        farthest = std::max(farthest, out.dot(px - a) / std::max(out.norm(), 1e-12));
    }
    return farthest;
}

}  // namespace atrium::coherence
