#include "site_node/hull/visual_hull.hpp"

#include "core/base/thread_pool.hpp"
#include "tests/support/allocation_counter.hpp"
#include "tests/support/rig_maker.hpp"
#include "tests/support/silhouette_maker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace atrium::hull {
namespace {

using test::Contour;

VisualHull exact_hull_of(const std::vector<SilhouetteView>& views) {
    HullOptions options;
    options.keep_phantoms = true;
    HullScratch scratch;
    return compute_visual_hull(views, options, scratch);
}

void expect_sound(const VisualHull& hull) {
    ASSERT_EQ(hull.status, HullStatus::kOk) << to_string(hull.status);
    const geometry::MeshReport report = geometry::inspect(hull.mesh);
    EXPECT_TRUE(report.closed);
    EXPECT_TRUE(report.manifold);
    EXPECT_GT(report.volume_m3, 0.0);
    EXPECT_EQ(report.num_components, hull.num_components);
    // general position: three faces in every vertex, and no vertex was added to triangulate
    EXPECT_EQ(hull.mesh.vertices.size() % 2, 0u);
    EXPECT_EQ(
        static_cast<std::int64_t>(hull.mesh.triangles.size()),
        2 * static_cast<std::int64_t>(hull.mesh.vertices.size()) - 2 * report.euler_characteristic);
}

// Cameras `distance_m` from the origin on the given axes, so far away that their cones are nearly
// cylinders.
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

// 512-gons inside the circles: their area is the circle's times this
const double kPolygonFactor =
    std::sin(2.0 * std::numbers::pi / 512) / (2.0 * std::numbers::pi / 512);

std::vector<SilhouetteView> unit_disc_views(const std::vector<geometry::CalibratedCamera>& rig,
                                            double distance_m) {
    // seen from the distance, the unit sphere's tangent cone has this radius on the plane through
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
    // cones instead of cylinders and polygons instead of circles: both below 1e-4 here
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

TEST(VisualHull, OfTwoCamerasThatFaceEachOtherIsADoubleConeWithTheirCentres) {
    // each epipole lies in the middle of the other silhouette, and both camera centres belong to
    // the hull
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
            // neighbours on the ring: bounded, but long
            ASSERT_EQ(hull.status, HullStatus::kOk) << to_string(hull.status);
        }
        expect_sound(hull);
        const double volume = geometry::volume_m3(hull.mesh);
        EXPECT_LE(volume, last) << n;
        last = volume;
        for (const Eigen::Vector3d& direction : kAxes) {
            for (const double sign : {-0.999, 0.999}) {
                const Eigen::Vector3d p = sphere.centre_site + sign * sphere.radius_m * direction;
                EXPECT_NEAR(geometry::winding_number(hull.mesh, p), 1.0, 1e-6);
            }
        }
    }
    const double ball = 4.0 / 3.0 * std::numbers::pi * 0.125;
    EXPECT_GT(last, ball);
    EXPECT_LT(last, 1.05 * ball);  // eight views bound a sphere to 3 %
}

TEST(VisualHull, OfABoxSeenAlongItsEdgesIsTheBox) {
    // each camera sees two faces edge-on, every edge of the box is seen by several cameras: the
    // worst case for predicates
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
        EXPECT_NEAR(geometry::winding_number(hull.mesh, inside), 1.0, 1e-6);
    }
}

// A cube-like body from two cameras, through which a third one sees a hole that lies inside of one
// face of the body.
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
    EXPECT_EQ(report.euler_characteristic, -2 + 2);  // a body with two handles, a rod
    const double expected = geometry::volume_m3(with_third({body_}).mesh) -
                            geometry::volume_m3(with_third({hole_}).mesh) +
                            geometry::volume_m3(with_third({island}).mesh) -
                            geometry::volume_m3(with_third({other_hole}).mesh);
    EXPECT_NEAR(report.volume_m3, expected, 1e-8 * expected);
}

class HullOfASphere : public testing::Test {
protected:
    std::vector<SilhouetteView> views_ =
        test::views_of(test::Sphere{{0.0, 0.1, 0.9}, 0.4}, test::make_ring_rig({}), 40);
    HullScratch scratch_;
};

TEST_F(HullOfASphere, IsTheSameToTheBitOnAnyNumberOfWorkers) {
    ThreadPool pool(4);
    VisualHull parallel;
    const VisualHull serial = compute_visual_hull(views_, {}, scratch_);
    for (int round = 0; round < 20; ++round) {
        compute_visual_hull(views_, {}, scratch_, pool, parallel);
        ASSERT_EQ(serial.mesh.vertices, parallel.mesh.vertices);
        ASSERT_EQ(serial.mesh.triangles, parallel.mesh.triangles);
    }
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

TEST_F(HullOfASphere, IgnoresACameraThatIsThereTwice) {
    const VisualHull once = compute_visual_hull(views_, {}, scratch_);
    views_.push_back(views_[3]);
    const VisualHull twice = compute_visual_hull(views_, {}, scratch_);
    EXPECT_EQ(twice.num_views_merged, 1u);
    EXPECT_EQ(once.mesh.vertices, twice.mesh.vertices);
}

TEST_F(HullOfASphere, IntersectsTwoSilhouettesOfOneCamera) {
    // no baseline between them: the hull is that of the two silhouettes' intersection
    const double whole = geometry::volume_m3(compute_visual_hull(views_, {}, scratch_).mesh);
    views_.push_back(views_[0]);
    for (auto& p : views_.back().contours[0]) p.x() += 40.0;
    const VisualHull hull = compute_visual_hull(views_, {}, scratch_);
    expect_sound(hull);
    EXPECT_LT(geometry::volume_m3(hull.mesh), 0.98 * whole);
    EXPECT_GT(geometry::volume_m3(hull.mesh), 0.5 * whole);
}

TEST_F(HullOfASphere, IsEmptyWhereOneCameraSeesNobody) {
    views_[5].contours.clear();
    const VisualHull hull = compute_visual_hull(views_, {}, scratch_);
    EXPECT_EQ(hull.status, HullStatus::kEmptyIntersection);
    EXPECT_TRUE(hull.mesh.empty());
}

TEST_F(HullOfASphere, IsEmptyWhereConesMissEachOther) {
    for (auto& p : views_[2].contours[0]) p.x() += 5000.0;
    EXPECT_EQ(compute_visual_hull(views_, {}, scratch_).status, HullStatus::kEmptyIntersection);
}

TEST_F(HullOfASphere, NeedsTwoViews) {
    EXPECT_EQ(compute_visual_hull(std::span(views_).first(1), {}, scratch_).status,
              HullStatus::kTooFewViews);
    EXPECT_EQ(compute_visual_hull({}, {}, scratch_).status, HullStatus::kTooFewViews);
    const std::vector<SilhouetteView> same{views_[0], views_[0]};
    EXPECT_EQ(compute_visual_hull(same, {}, scratch_).status, HullStatus::kTooFewViews);
}

TEST_F(HullOfASphere, IsUnboundedWhereAllCamerasLookTheSameWay) {
    SilhouetteView beside = views_[0];
    beside.camera_from_site.translation.x() += 0.3;
    const std::vector<SilhouetteView> pair{views_[0], beside};
    EXPECT_EQ(compute_visual_hull(pair, {}, scratch_).status, HullStatus::kUnbounded);
}

TEST_F(HullOfASphere, RefusesNumbersThatAreNone) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const auto status_with = [&](auto change) {
        std::vector<SilhouetteView> views = views_;
        change(views[1]);
        return compute_visual_hull(views, {}, scratch_).status;
    };
    using View = SilhouetteView;
    EXPECT_EQ(status_with([&](View& v) { v.contours[0][7].x() = kNan; }),
              HullStatus::kInvalidInput);
    EXPECT_EQ(status_with([&](View& v) { v.contours[0][7].y() = kInfinity; }),
              HullStatus::kInvalidInput);
    EXPECT_EQ(status_with([&](View& v) { v.contours[0][7].y() = 1e300; }),
              HullStatus::kInvalidInput);
    EXPECT_EQ(status_with([&](View& v) { v.intrinsics.fx = 0.0; }), HullStatus::kInvalidInput);
    EXPECT_EQ(status_with([&](View& v) { v.intrinsics.cy = kNan; }), HullStatus::kInvalidInput);
    EXPECT_EQ(status_with([&](View& v) { v.camera_from_site.translation.z() = kInfinity; }),
              HullStatus::kInvalidInput);
    EXPECT_EQ(status_with([&](View& v) { v.camera_from_site.rotation.coeffs().setZero(); }),
              HullStatus::kInvalidInput);
}

TEST_F(HullOfASphere, RefusesMoreViewsThanItCanName) {
    const std::vector<SilhouetteView> views(kMaxViews + 1, views_[0]);
    EXPECT_EQ(compute_visual_hull(views, {}, scratch_).status, HullStatus::kInvalidInput);
}

TEST_F(HullOfASphere, RefusesMoreWorkThanAllowed) {
    HullOptions options;
    options.max_segments = 100;
    EXPECT_EQ(compute_visual_hull(views_, options, scratch_).status, HullStatus::kTooComplex);
}

TEST_F(HullOfASphere, StopsAfterTheAllowedSteps) {
    // twelve combs across each other: many crossings on every strip
    std::vector<SilhouetteView> views;
    for (const auto& camera : test::make_ring_rig({.num_cameras = 12})) {
        Contour comb;
        for (int i = 0; i < 120; ++i)
            comb.emplace_back(i % 2 == 0 ? 200.0 : 800.0, 200.0 + 4.0 * i);
        for (int i = 119; i >= 0; --i)
            comb.emplace_back(i % 2 == 0 ? 202.0 : 802.0, 202.0 + 4.0 * i);
        views.push_back(test::make_view(camera, {comb}));
    }
    HullOptions options;
    options.max_steps = 1000;
    EXPECT_EQ(compute_visual_hull(views, options, scratch_).status, HullStatus::kTooComplex);
}

TEST_F(HullOfASphere, LeavesOutContoursWithoutArea) {
    const VisualHull clean = compute_visual_hull(views_, {}, scratch_);
    views_[0].contours.push_back({{10.0, 10.0}, {20.0, 10.0}, {30.0, 10.0}});
    views_[1].contours.push_back({{10.0, 10.0}});
    views_[2].contours.emplace_back();
    const VisualHull hull = compute_visual_hull(views_, {}, scratch_);
    EXPECT_EQ(hull.num_contours_dropped, 3u);
    EXPECT_EQ(clean.mesh.vertices, hull.mesh.vertices);
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

TEST(VisualHull, Takes64Views) {
    const auto rig = test::make_ring_rig({.num_cameras = 64, .heights_m = {0.4, 1.1, 1.8, 2.4}});
    const VisualHull hull =
        exact_hull_of(test::views_of(test::Sphere{{0.0, 0.0, 0.9}, 0.4}, rig, 20));
    expect_sound(hull);
}

TEST(VisualHull, DropsPhantomsUnlessAskedToKeepThem) {
    // two people, three cameras: where a ray past one meets rays past the other there is a body
    // that nobody has
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
    EXPECT_LE(geometry::volume_m3(cleaned.mesh), geometry::volume_m3(exact.mesh));
    for (const test::Sphere& sphere : {a, b}) {
        EXPECT_NEAR(geometry::winding_number(cleaned.mesh, sphere.centre_site), 1.0, 1e-6);
    }
}

}  // namespace
}  // namespace atrium::hull
