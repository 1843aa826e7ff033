#include "site_node/hull/visual_hull.hpp"

#include "tests/support/allocation_counter.hpp"
#include "tests/support/shapes/hull_checks.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/silhouette_maker.hpp"
#include "tests/support/shapes/winding_number.hpp"
#include "tests/unit/hull/hull_of_a_sphere.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace atrium::hull {
namespace {

using test::Contour;
using test::exact_hull_of;
using test::expect_sound;

// Cameras `distance_m` from the origin on the given axes. They are so far away that their cones are
// nearly cylinders.
std::vector<geometry::CalibratedCamera> far_cameras(const std::vector<Eigen::Vector3d>& directions,
                                                    double distance_m) {
    std::vector<geometry::CalibratedCamera> rig;
    for (const Eigen::Vector3d& direction : directions) {
        geometry::CalibratedCamera camera;
        camera.intrinsics = {1000, 1000, 400.0 * distance_m, 400.0 * distance_m, 499.5, 499.5};
        camera.camera_from_site = test::look_at(distance_m * direction, Eigen::Vector3d::Zero());
        rig.push_back(camera);
    }
    return rig;
}

const std::vector<Eigen::Vector3d> kAxes{
    Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()};

// 512-gons inside the circles: their area is this fraction of the circle's
const double kPolygonFactor =
    std::sin(2.0 * std::numbers::pi / 512) / (2.0 * std::numbers::pi / 512);

std::vector<SilhouetteView> unit_disc_views(const std::vector<geometry::CalibratedCamera>& rig,
                                            double distance_m) {
    // from this distance, the tangent cone of the unit sphere has this radius on the plane through
    // its centre
    const double radius_px = 400.0 * distance_m / std::sqrt(distance_m * distance_m - 1.0);
    std::vector<SilhouetteView> views;
    for (const auto& camera : rig) {
        views.push_back(test::make_view(
            camera, {test::regular_polygon({499.5, 499.5}, radius_px, 512, 0.0031)}));
    }
    return views;
}

TEST(VisualHull, OfASphereFromTwoFarCamerasIsSteinmetzBicylinder) {
    const auto rig = far_cameras({kAxes[0], kAxes[1]}, 500.0);
    const VisualHull hull = exact_hull_of(unit_disc_views(rig, 500.0));
    expect_sound(hull);
    // cones instead of cylinders and polygons instead of circles: both errors are below 1e-4 here
    EXPECT_NEAR(geometry::volume_m3(hull.mesh), 16.0 / 3.0, 16.0 / 3.0 * 1e-4);
    EXPECT_LT(kPolygonFactor, 1.0);
}

TEST(VisualHull, OfASphereFromThreeFarCamerasIsSteinmetzTricylinder) {
    const auto rig = far_cameras(kAxes, 500.0);
    const VisualHull hull = exact_hull_of(unit_disc_views(rig, 500.0));
    expect_sound(hull);
    const double exact = 8.0 * (2.0 - std::numbers::sqrt2);
    EXPECT_NEAR(geometry::volume_m3(hull.mesh), exact, exact * 1e-4);
}

TEST(VisualHull, OfTwoFacingCamerasIsADoubleConeWithTheirCentres) {
    // each epipole lies in the middle of the other silhouette, and the hull contains both camera
    // centres
    constexpr double kDistance_m = 6.0;
    constexpr int kCorners = 24;
    constexpr double kRadius_px = 130.0;
    geometry::CalibratedCamera left;
    left.intrinsics = {1000, 1000, 1300.0, 1300.0, 499.5, 499.5};
    geometry::CalibratedCamera right = left;
    left.camera_from_site = test::look_at({-0.5 * kDistance_m, 0.0, 0.0}, Eigen::Vector3d::Zero());
    right.camera_from_site = test::look_at({0.5 * kDistance_m, 0.0, 0.0}, Eigen::Vector3d::Zero());
    const VisualHull hull = exact_hull_of({
        test::make_view(left, {test::regular_polygon({499.5, 499.5}, kRadius_px, kCorners, 0.1)}),
        // the same directions, seen from behind
        test::make_view(
            right,
            {test::regular_polygon({499.5, 499.5}, kRadius_px, kCorners, std::numbers::pi - 0.1)}),
    });
    ASSERT_EQ(hull.status, HullStatus::kOk) << to_string(hull.status);
    const geometry::MeshReport report = geometry::inspect(hull.mesh);
    EXPECT_TRUE(report.manifold);
    EXPECT_EQ(report.euler_characteristic, 2);
    const double area_at_depth_1 = 0.5 * kCorners * std::sin(2.0 * std::numbers::pi / kCorners) *
                                   kRadius_px * kRadius_px / 1300.0 / 1300.0;
    const double half = 0.5 * kDistance_m;
    const double exact = 2.0 / 3.0 * area_at_depth_1 * half * half * half;
    EXPECT_NEAR(report.volume_m3, exact, exact * 1e-7);
    EXPECT_NEAR(geometry::bounds(hull.mesh).min.x(), -half, 1e-9);
    EXPECT_NEAR(geometry::bounds(hull.mesh).max.x(), half, 1e-9);
}

TEST(VisualHull, ContainsTheSphereAndShrinksWithMoreCameras) {
    const test::Sphere sphere{{0.1, 0.0, 1.0}, 0.5};
    const auto rig = test::make_ring_rig({.num_cameras = 8});
    const auto views = test::views_of(sphere, rig, 60);
    double last = std::numeric_limits<double>::infinity();
    for (std::size_t n = 2; n <= views.size(); ++n) {
        const VisualHull hull =
            exact_hull_of({views.begin(), views.begin() + static_cast<std::ptrdiff_t>(n)});
        if (n == 2) {
            // neighbours on the ring: the hull is bounded, but long
            ASSERT_EQ(hull.status, HullStatus::kOk) << to_string(hull.status);
        }
        expect_sound(hull);
        const double volume = geometry::volume_m3(hull.mesh);
        EXPECT_LE(volume, last) << n;
        last = volume;
        for (const Eigen::Vector3d& direction : kAxes) {
            for (const double sign : {-0.999, 0.999}) {
                const Eigen::Vector3d p = sphere.centre_site + sign * sphere.radius_m * direction;
                EXPECT_NEAR(test::winding_number(hull.mesh, p), 1.0, 1e-6);
            }
        }
    }
    const double ball = 4.0 / 3.0 * std::numbers::pi * 0.125;
    EXPECT_GT(last, ball);
    EXPECT_LT(last, 1.05 * ball);  // eight views bound a sphere to 3 %
}

TEST(VisualHull, OfABoxSeenAlongItsEdgesIsTheBox) {
    // Each camera sees two faces edge-on, and several cameras see every edge of the box: the worst
    // case for the predicates.
    std::vector<Eigen::Vector3d> corners;
    for (const double x : {-0.4, 0.4}) {
        for (const double y : {-0.4, 0.4}) {
            for (const double z : {0.5, 1.3}) corners.emplace_back(x, y, z);
        }
    }
    const auto views =
        test::views_of(corners, test::make_ring_rig({.num_cameras = 8, .heights_m = {0.9}}));
    const VisualHull hull = exact_hull_of(views);
    ASSERT_EQ(hull.status, HullStatus::kOk) << to_string(hull.status);
    EXPECT_TRUE(geometry::inspect(hull.mesh).manifold);
    for (const Eigen::Vector3d& corner : corners) {
        const Eigen::Vector3d inside =
            Eigen::Vector3d(0.0, 0.0, 0.9) + 0.999 * (corner - Eigen::Vector3d(0.0, 0.0, 0.9));
        EXPECT_NEAR(test::winding_number(hull.mesh, inside), 1.0, 1e-6);
    }
}

// A body like a cube from two cameras. A third camera sees a hole through it that lies inside one
// face.
class DrilledBody : public testing::Test {
protected:
    std::vector<geometry::CalibratedCamera> rig_ = far_cameras(kAxes, 8.0);
    const Contour body_{{299.0, 301.0}, {702.0, 298.0}, {698.0, 703.0}, {297.0, 699.0}};
    const Contour hole_ = test::regular_polygon({480.0, 520.0}, 60.0, 7);

    VisualHull with_third(std::vector<Contour> contours) const {
        return exact_hull_of({test::make_view(rig_[0], {body_}),
                              test::make_view(rig_[1], {body_}),
                              test::make_view(rig_[2], std::move(contours))});
    }
};

TEST_F(DrilledBody, HasFacesWithInnerLoopsAndOneHandle) {
    const VisualHull hull = with_third({body_, hole_});
    expect_sound(hull);
    EXPECT_EQ(geometry::inspect(hull.mesh).euler_characteristic, 0);
}

TEST_F(DrilledBody, LacksExactlyTheDrillCore) {
    const double drilled = geometry::volume_m3(with_third({body_, hole_}).mesh);
    const double whole = geometry::volume_m3(with_third({body_}).mesh);
    const double core = geometry::volume_m3(with_third({hole_}).mesh);
    EXPECT_GT(core, 0.0);
    EXPECT_NEAR(drilled, whole - core, 1e-8 * whole);
}

TEST_F(DrilledBody, DoesNotDependOnOrientationStartOrOrderOfContours) {
    Contour reversed(hole_.rbegin(), hole_.rend());
    std::rotate(reversed.begin(), reversed.begin() + 3, reversed.end());
    const VisualHull a = with_third({body_, hole_});
    const VisualHull b = with_third({reversed, body_});
    EXPECT_EQ(a.mesh.vertices, b.mesh.vertices);
    EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
}

TEST_F(DrilledBody, HandlesSeveralHolesAndIslands) {
    const Contour island = test::regular_polygon({480.0, 520.0}, 30.0, 5);
    const Contour other_hole = test::regular_polygon({600.0, 400.0}, 45.0, 4);
    const VisualHull hull = with_third({body_, hole_, island, other_hole});
    expect_sound(hull);
    const geometry::MeshReport report = geometry::inspect(hull.mesh);
    EXPECT_EQ(report.num_components, 2u);  // the island is a rod inside the first drill hole
    EXPECT_EQ(report.euler_characteristic, -2 + 2);  // a body with two handles, and a rod
    const double expected = geometry::volume_m3(with_third({body_}).mesh) -
                            geometry::volume_m3(with_third({hole_}).mesh) +
                            geometry::volume_m3(with_third({island}).mesh) -
                            geometry::volume_m3(with_third({other_hole}).mesh);
    EXPECT_NEAR(report.volume_m3, expected, 1e-8 * expected);
}

TEST_F(HullOfASphere, AllocatesNothingOnceWarm) {
    SerialExecutor executor;
    VisualHull hull;
    for (int i = 0; i < 2; ++i) compute_visual_hull(views_, {}, scratch_, executor, hull);
    const std::uint64_t before = test::num_allocations();
    compute_visual_hull(views_, {}, scratch_, executor, hull);
    EXPECT_EQ(test::num_allocations() - before, 0u);
    EXPECT_EQ(hull.status, HullStatus::kOk);
}

TEST_F(HullOfASphere, IgnoresADuplicateCamera) {
    const VisualHull once = compute_visual_hull(views_, {}, scratch_);
    views_.push_back(views_[3]);
    const VisualHull twice = compute_visual_hull(views_, {}, scratch_);
    EXPECT_EQ(twice.num_views_merged, 1u);
    EXPECT_EQ(once.mesh.vertices, twice.mesh.vertices);
}

TEST_F(HullOfASphere, IntersectsTwoSilhouettesOfOneCamera) {
    // without a baseline between them, the hull is that of the intersection of the two silhouettes
    const double whole = geometry::volume_m3(compute_visual_hull(views_, {}, scratch_).mesh);
    views_.push_back(views_[0]);
    for (auto& p : views_.back().contours[0]) p.x() += 40.0;
    const VisualHull hull = compute_visual_hull(views_, {}, scratch_);
    expect_sound(hull);
    EXPECT_LT(geometry::volume_m3(hull.mesh), 0.98 * whole);
    EXPECT_GT(geometry::volume_m3(hull.mesh), 0.5 * whole);
}

TEST_F(HullOfASphere, KeepsItsVolumeWithCollinearPoints) {
    const VisualHull plain = compute_visual_hull(views_, {}, scratch_);
    for (SilhouetteView& view : views_) {
        Contour dense;
        const Contour& contour = view.contours[0];
        for (std::size_t i = 0; i < contour.size(); ++i) {
            dense.push_back(contour[i]);
            dense.emplace_back(0.5 * (contour[i] + contour[(i + 1) % contour.size()]));
        }
        view.contours[0] = dense;
    }
    const VisualHull dense = compute_visual_hull(views_, {}, scratch_);
    expect_sound(dense);
    EXPECT_GT(dense.mesh.vertices.size(), plain.mesh.vertices.size());
    EXPECT_NEAR(geometry::volume_m3(dense.mesh), geometry::volume_m3(plain.mesh), 1e-8);
}

TEST(VisualHull, Accepts64Views) {
    const auto rig = test::make_ring_rig({.num_cameras = 64, .heights_m = {0.4, 1.1, 1.8, 2.4}});
    const VisualHull hull =
        exact_hull_of(test::views_of(test::Sphere{{0.0, 0.0, 0.9}, 0.4}, rig, 20));
    expect_sound(hull);
}

TEST(VisualHull, DropsPhantomsUnlessKept) {
    // Two people, three cameras. Where a ray past one person meets rays past the other, a phantom
    // body appears.
    const auto rig =
        test::make_ring_rig({.num_cameras = 3, .heights_m = {1.0}, .first_angle_rad = 0.2});
    const test::Sphere a{{-0.6, 0.1, 0.9}, 0.15};
    const test::Sphere b{{0.6, -0.1, 0.9}, 0.15};
    std::vector<SilhouetteView> views;
    for (const auto& camera : rig) {
        views.push_back(test::make_view(
            camera, {test::outline_of(a, camera, 12), test::outline_of(b, camera, 12)}));
    }
    HullScratch scratch;
    const VisualHull cleaned = compute_visual_hull(views, {}, scratch);
    const VisualHull exact = exact_hull_of(views);
    expect_sound(cleaned);
    expect_sound(exact);
    EXPECT_EQ(
        exact.num_components,
        cleaned.num_components + cleaned.num_phantoms_dropped + cleaned.num_fragments_dropped);
    EXPECT_NEAR(geometry::volume_m3(cleaned.mesh) + cleaned.volume_dropped_m3,
                geometry::volume_m3(exact.mesh),
                1e-12);
    for (const test::Sphere& sphere : {a, b}) {
        EXPECT_NEAR(test::winding_number(cleaned.mesh, sphere.centre_site), 1.0, 1e-6);
    }
}

}  // namespace
}  // namespace atrium::hull
