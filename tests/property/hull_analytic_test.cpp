#include "site_node/hull/visual_hull.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/silhouette_maker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

// Hulls whose volume is known from a formula, or from an integral that shares nothing with
// polyhedra.
namespace atrium::hull {
namespace {

constexpr double kDistance_m = 500.0;
constexpr int kCorners = 512;

VisualHull exact_hull_of(const std::vector<SilhouetteView>& views) {
    HullOptions options;
    options.keep_phantoms = true;
    HullScratch scratch;
    return compute_visual_hull(views, options, scratch);
}

// The unit sphere from far away along the axes, as 512-gons inside its outlines.
std::vector<SilhouetteView> far_discs(int num_axes) {
    const double radius_px = 400.0 * kDistance_m / std::sqrt(kDistance_m * kDistance_m - 1.0);
    std::vector<SilhouetteView> views;
    for (int axis = 0; axis < num_axes; ++axis) {
        geometry::CalibratedCamera camera;
        camera.intrinsics = {1000, 1000, 400.0 * kDistance_m, 400.0 * kDistance_m, 499.5, 499.5};
        camera.camera_from_site =
            test::look_at(kDistance_m * Eigen::Vector3d::Unit(axis), Eigen::Vector3d::Zero());
        views.push_back(test::make_view(
            camera, {test::regular_polygon({499.5, 499.5}, radius_px, kCorners, 0.0031)}));
    }
    return views;
}

// 16/3 and 8 (2 - sqrt 2) for cylinders. The values for cones of 512-gons come from a mesh boolean
// that shares nothing with this hull, to six decimals.
TEST(AnalyticHull, OfTwoFarDiscsIsSteinmetzBicylinder) {
    const VisualHull hull = exact_hull_of(far_discs(2));
    ASSERT_EQ(hull.status, HullStatus::kOk);
    EXPECT_NEAR(geometry::volume_m3(hull.mesh), 5.333161, 2e-6);
    EXPECT_LT(geometry::volume_m3(hull.mesh), 16.0 / 3.0);
}

TEST(AnalyticHull, OfThreeFarDiscsIsSteinmetzTricylinderWithEightTriplePoints) {
    const std::vector<SilhouetteView> views = far_discs(3);
    const VisualHull hull = exact_hull_of(views);
    ASSERT_EQ(hull.status, HullStatus::kOk);
    EXPECT_NEAR(geometry::volume_m3(hull.mesh), 4.686125, 2e-6);
    EXPECT_LT(geometry::volume_m3(hull.mesh), 8.0 * (2.0 - std::numbers::sqrt2));
    // A triple point lies on three outlines and on no corner of any. All other points lie on a
    // viewing line, and therefore on a corner.
    std::size_t num_triple_points = 0;
    for (const Eigen::Vector3d& p : hull.mesh.vertices) {
        double nearest_corner_px = std::numeric_limits<double>::infinity();
        for (const SilhouetteView& view : views) {
            const Eigen::Vector2d seen = view.intrinsics.project(view.camera_from_site * p);
            for (const Eigen::Vector2d& corner : view.contours[0])
                nearest_corner_px = std::min(nearest_corner_px, (corner - seen).norm());
        }
        num_triple_points += nearest_corner_px > 1e-4 ? 1 : 0;
    }
    EXPECT_EQ(num_triple_points, 8u);
}

// Volume of the intersection of a sphere's tangent cones, by integration over all directions from
// the sphere's centre. The body is star-shaped from there.
double volume_between_tangent_cones(const test::Sphere& sphere,
                                    const std::vector<Eigen::Vector3d>& cameras) {
    constexpr int kRows = 1500;
    double volume_m3 = 0.0;
    for (int row = 0; row < kRows; ++row) {
        const double z = (2.0 * row + 1.0) / kRows - 1.0;  // equal areas
        for (int column = 0; column < 2 * kRows; ++column) {
            const double angle = std::numbers::pi * (column + 0.5) / kRows;
            const double flat = std::sqrt(1.0 - z * z);
            const Eigen::Vector3d direction(flat * std::cos(angle), flat * std::sin(angle), z);
            double reach_m = std::numeric_limits<double>::infinity();
            for (const Eigen::Vector3d& camera : cameras) {
                // height above the cone's axis against its radius there
                const Eigen::Vector3d to_sphere = sphere.centre_site - camera;
                const double distance_m = to_sphere.norm();
                const double along = direction.dot(to_sphere) / distance_m;
                const double across = std::sqrt(std::max(0.0, 1.0 - along * along));
                const double slope = sphere.radius_m / std::sqrt(distance_m * distance_m -
                                                                 sphere.radius_m * sphere.radius_m);
                const double opening = across - slope * along;
                if (opening > 0.0) reach_m = std::min(reach_m, slope * distance_m / opening);
            }
            volume_m3 += reach_m * reach_m * reach_m / 3.0;
        }
    }
    return volume_m3 * 2.0 * std::numbers::pi / kRows / kRows;
}

TEST(AnalyticHull, OfASphereIsBetweenItsTangentCones) {
    const test::Sphere sphere{{0.0, 0.0, 0.9}, 0.5};
    const auto rig = test::make_ring_rig({.num_cameras = 8, .radius_m = 3.2});
    std::vector<Eigen::Vector3d> centres;
    for (const auto& camera : rig) centres.push_back(camera.centre_site());
    const double smooth_m3 = volume_between_tangent_cones(sphere, centres);
    constexpr int kSides = 360;
    const VisualHull hull = exact_hull_of(test::views_of(sphere, rig, kSides));
    ASSERT_EQ(hull.status, HullStatus::kOk);
    // The outlines are polygons around the ellipses. A polygon with its corners on them is smaller
    // by 1 / cos(pi / n).
    const double volume_m3 = geometry::volume_m3(hull.mesh);
    const double grow = 1.0 / std::cos(std::numbers::pi / kSides);
    EXPECT_GT(volume_m3, smooth_m3 * (1.0 - 1e-6));
    EXPECT_LT(volume_m3, smooth_m3 * grow * grow * grow * (1.0 + 1e-6));
}

}  // namespace
}  // namespace atrium::hull
