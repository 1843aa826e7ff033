#include "tests/support/shapes/silhouette_maker.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace atrium::test {
namespace {

double cross(const Eigen::Vector2d& o, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return (a.x() - o.x()) * (b.y() - o.y()) - (a.y() - o.y()) * (b.x() - o.x());
}

}  // namespace

// Monotone chain.
Contour convex_hull(Contour points) {
    std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
        return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
    });
    Contour hull;
    for (int half = 0; half < 2; ++half) {
        const std::size_t start = hull.size();
        for (const Eigen::Vector2d& p : points) {
            while (hull.size() >= start + 2 && cross(hull[hull.size() - 2], hull.back(), p) <= 0.0)
                hull.pop_back();
            hull.push_back(p);
        }
        hull.pop_back();
        std::reverse(points.begin(), points.end());
    }
    return hull;
}

Contour outline_of(const Sphere& sphere,
                   const geometry::CalibratedCamera& camera,
                   int num_vertices) {
    // the tangent cone around the ray to the centre, cut by planes that touch it
    const Eigen::Vector3d centre = camera.camera_from_site * sphere.centre_site;
    const Eigen::Vector3d axis = centre.normalized();
    const Eigen::Vector3d e1 = axis.unitOrthogonal();
    const Eigen::Vector3d e2 = axis.cross(e1);
    const double tan_half = std::tan(std::asin(sphere.radius_m / centre.norm()));
    const double grow = 1.0 / std::cos(std::numbers::pi / num_vertices);
    Contour contour;
    for (int i = 0; i < num_vertices; ++i) {
        const double angle = 2.0 * std::numbers::pi * (i + 0.37) / num_vertices;
        const Eigen::Vector3d ray =
            axis + tan_half * grow * (std::cos(angle) * e1 + std::sin(angle) * e2);
        contour.push_back(camera.intrinsics.project(ray));
    }
    return contour;
}

Contour outline_of(std::span<const Eigen::Vector3d> points_site,
                   const geometry::CalibratedCamera& camera) {
    Contour projected;
    for (const Eigen::Vector3d& p : points_site)
        projected.push_back(camera.intrinsics.project(camera.camera_from_site * p));
    return convex_hull(projected);
}

Contour regular_polygon(const Eigen::Vector2d& centre_px,
                        double radius_px,
                        int num_vertices,
                        double phase_rad) {
    Contour contour;
    for (int i = 0; i < num_vertices; ++i) {
        const double angle = phase_rad + 2.0 * std::numbers::pi * i / num_vertices;
        contour.emplace_back(centre_px +
                             radius_px * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
    return contour;
}

Contour random_star(Random& random,
                    const Eigen::Vector2d& centre_px,
                    double radius_px,
                    int num_vertices) {
    std::uniform_real_distribution<double> share(0.5, 1.0);
    std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
    Contour contour = regular_polygon(centre_px, radius_px, num_vertices, phase(random));
    for (Eigen::Vector2d& p : contour) p = centre_px + share(random) * (p - centre_px);
    return contour;
}

std::vector<Contour> random_stars(Random& random, int most_vertices) {
    Eigen::Vector2d middle;
    for (double& coordinate : middle) coordinate = between(random, 450.0, 550.0);
    const double radius_px = between(random, 100.0, 250.0);
    const auto star = [&](const Eigen::Vector2d& centre_px, double share, int most) {
        const int num_vertices = between(random, 3, most);
        return random_star(random, centre_px, share * radius_px, num_vertices);
    };
    const int most_of_small = 3 + most_vertices / 5;
    std::vector<Contour> contours{star(middle, 1.0, most_vertices)};
    if (between(random, 0, 2) == 0) contours.push_back(star(middle, 0.24, most_of_small));
    const Eigen::Vector2d beside = middle + Eigen::Vector2d(1.6 * radius_px, 0.0);
    if (between(random, 0, 2) == 0) contours.push_back(star(beside, 0.5, most_of_small));
    return contours;
}

hull::SilhouetteView make_view(const geometry::CalibratedCamera& camera,
                               std::vector<Contour> contours) {
    return {camera.intrinsics, camera.camera_from_site, std::move(contours), {}};
}

std::vector<hull::SilhouetteView> views_of(const Sphere& sphere,
                                           std::span<const geometry::CalibratedCamera> rig,
                                           int num_vertices) {
    std::vector<hull::SilhouetteView> views;
    for (const auto& camera : rig)
        views.push_back(make_view(camera, {outline_of(sphere, camera, num_vertices)}));
    return views;
}

std::vector<hull::SilhouetteView> views_of(std::span<const Eigen::Vector3d> points_site,
                                           std::span<const geometry::CalibratedCamera> rig) {
    std::vector<hull::SilhouetteView> views;
    for (const auto& camera : rig)
        views.push_back(make_view(camera, {outline_of(points_site, camera)}));
    return views;
}

Membership membership(const Eigen::Vector3d& p_site, std::span<const hull::SilhouetteView> views) {
    Membership result{true, std::numeric_limits<double>::infinity()};
    for (const hull::SilhouetteView& view : views) {
        const Eigen::Vector3d p_camera = view.camera_from_site * p_site;
        if (p_camera.z() <= 0.0) return {false, std::numeric_limits<double>::infinity()};
        const Eigen::Vector2d p = view.intrinsics.project(p_camera);
        result.inside = result.inside && even_odd(view.contours, p);
        result.margin_px = std::min(result.margin_px, distance_to_edges(view.contours, p));
    }
    return result;
}

}  // namespace atrium::test
