#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "tests/support/random.hpp"
#include "tests/support/shapes/polygons.hpp"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace atrium::test {

struct Sphere {
    Eigen::Vector3d centre_site = Eigen::Vector3d::Zero();
    double radius_m = 1.0;
};

/// Outline of a sphere: a polygon around the exact ellipse that touches it in the middle of each
/// edge. The hull therefore contains the sphere.
Contour outline_of(const Sphere& sphere,
                   const geometry::CalibratedCamera& camera,
                   int num_vertices);

/// Outline of the convex hull of `points_site`.
Contour outline_of(std::span<const Eigen::Vector3d> points_site,
                   const geometry::CalibratedCamera& camera);

/// Counter-clockwise with +Y up, without collinear points.
Contour convex_hull(Contour points);

/// Regular polygon, counter-clockwise with +Y up, with its first vertex at `phase_rad`.
Contour regular_polygon(const Eigen::Vector2d& centre_px,
                        double radius_px,
                        int num_vertices,
                        double phase_rad = 0.1);

/// A random star-shaped polygon with radii in [0.5, 1] of `radius_px`.
Contour random_star(Random& random,
                    const Eigen::Vector2d& centre_px,
                    double radius_px,
                    int num_vertices);

/// A star of 3 to `most_vertices` around the middle of a picture of 1000 px, sometimes with a hole
/// and with an island beside it. Several stars are unrelated. As silhouettes of different cameras
/// they have more crossings, phantoms and handles than those of bodies.
std::vector<Contour> random_stars(Random& random, int most_vertices);

hull::SilhouetteView make_view(const geometry::CalibratedCamera& camera,
                               std::vector<Contour> contours);

std::vector<hull::SilhouetteView> views_of(const Sphere& sphere,
                                           std::span<const geometry::CalibratedCamera> rig,
                                           int num_vertices);
std::vector<hull::SilhouetteView> views_of(std::span<const Eigen::Vector3d> points_site,
                                           std::span<const geometry::CalibratedCamera> rig);

/// Whether a point lies inside all silhouettes by the even-odd rule, independent of the hull.
/// `margin_px` is the smallest distance to any outline, to skip undecidable points.
struct Membership {
    bool inside = false;
    double margin_px = 0.0;
};
Membership membership(const Eigen::Vector3d& p_site, std::span<const hull::SilhouetteView> views);

}  // namespace atrium::test
