#include "site_node/coherence/tangency.hpp"

#include "site_node/coherence/camera_fit.hpp"
#include "tests/support/people/walking_people.hpp"
#include "tests/support/random.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/silhouette_maker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace atrium::coherence {
namespace {

std::vector<geometry::CalibratedCamera> near_rig() { return test::make_ring_rig({}); }

// The exact outlines of the convex hull of points in the room.
std::vector<SilhouetteHull> see(std::span<const Eigen::Vector3d> points,
                                std::span<const geometry::CalibratedCamera> cameras) {
    std::vector<SilhouetteHull> hulls;
    for (const auto& camera : cameras) {
        const std::vector<std::vector<Eigen::Vector2d>> contours{test::outline_of(points, camera)};
        hulls.push_back(hull_of(contours, camera.intrinsics));
    }
    return hulls;
}

std::vector<Eigen::Vector3d> cloud(std::uint64_t seed) {
    test::Random random(seed);
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 200; ++i)
        points.push_back(Eigen::Vector3d(0.1, -0.2, 0.9) +
                         test::random_in_cube(random, 0.4).cwiseProduct(Eigen::Vector3d(1, 1, 2)));
    return points;
}

std::vector<Tangency> find(const std::vector<geometry::CalibratedCamera>& cameras,
                           const Sight& sight) {
    std::vector<Tangency> found;
    find_tangencies(cameras, sight, 0, {}, found);
    return found;
}

TEST(Tangencies, OfATrueRigHaveNoError) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const auto found = find(near_rig(), {see(cloud(seed), near_rig()), {}});
        EXPECT_GE(found.size(), 40u);
        for (const Tangency& t : found) {
            EXPECT_NEAR(t.error_px, 0.0, 1e-6);
            EXPECT_TRUE(std::isnan(t.motion_px));
        }
    }
}

TEST(Tangencies, DerivativesAreThoseOfTheError) {
    const auto cameras = near_rig();
    const Sight sight{see(cloud(3), cameras), {}};
    constexpr double kStep = 1e-5;
    const auto before = find(cameras, sight);
    for (const std::size_t moved : {0u, 3u}) {
        for (int axis = 0; axis < 6; ++axis) {
            const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(axis % 3);
            const Eigen::Vector3d none = Eigen::Vector3d::Zero();
            auto other = cameras;
            other[moved] = axis < 3 ? test::bumped(cameras[moved], step, none)
                                    : test::bumped(cameras[moved], none, step);
            const auto after = find(other, sight);
            ASSERT_EQ(after.size(), before.size());
            for (std::size_t i = 0; i < after.size(); ++i) {
                double expected = 0.0;
                for (const TangentEnd& end : before[i].ends) {
                    if (end.camera != moved) continue;
                    expected = axis < 3 ? end.by_turn[axis] : end.by_move[axis - 3];
                }
                const double slope = (after[i].error_px - before[i].error_px) / kStep;
                EXPECT_NEAR(slope, expected, 0.02 * std::abs(expected) + 3.0) << axis;
            }
        }
    }
}

TEST(Tangencies, OfWiderSilhouettesAreNoMotion) {
    const auto cameras = near_rig();
    Sight sight{see(cloud(4), cameras), {}};
    // the outline of camera 2 grows by a pixel
    std::vector<std::vector<Eigen::Vector2d>> wider(1);
    for (const Eigen::Vector2d& p : sight.now[2].points) {
        for (int k = 0; k < 360; ++k)
            wider[0].push_back(p + Eigen::AngleAxisd(0.0174533 * k, Eigen::Vector3d::UnitZ())
                                       .toRotationMatrix()
                                       .topLeftCorner<2, 1>());
    }
    sight.now[2] = hull_of(wider, cameras[2].intrinsics);
    const auto found = find(cameras, sight);
    const std::vector<double> dilations = find_dilations(found, cameras.size());
    for (std::size_t c = 0; c < cameras.size(); ++c)
        EXPECT_NEAR(dilations[c], c == 2 ? 1.0 : 0.0, 0.15) << c;
    for (const Tangency& t : found) {
        for (const TangentEnd& end : t.ends) {
            if (end.camera == 2) {
                EXPECT_NEAR(t.error_px, end.by_dilation, 0.02);
            }
        }
    }
}

TEST(Tangencies, AtTheBordersOfPicturesDoNotCount) {
    auto cameras = near_rig();
    const auto points = cloud(5);
    const std::size_t all = find(cameras, {see(points, cameras), {}}).size();
    // camera 1 ends in the middle of the body
    auto contour = test::outline_of(points, cameras[1]);
    double middle = 0.0;
    for (const auto& p : contour) middle += p.y() / static_cast<double>(contour.size());
    cameras[1].intrinsics.height = static_cast<int>(middle);
    for (auto& p : contour) p.y() = std::min(p.y(), cameras[1].intrinsics.height - 0.5);
    Sight sight{see(points, cameras), {}};
    sight.now[1] =
        hull_of(std::vector<std::vector<Eigen::Vector2d>>(1, contour), cameras[1].intrinsics);
    const auto found = find(cameras, sight);
    EXPECT_LT(found.size(), all);
    for (const Tangency& t : found) EXPECT_NEAR(t.error_px, 0.0, 1e-6);
}

TEST(Tangencies, OfSomebodyWhomOneCameraSeesDoNotCount) {
    const auto cameras = near_rig();
    Sight sight{see(cloud(6), cameras), {}};
    std::vector<std::vector<Eigen::Vector2d>> contours{sight.now[2].points,
                                                       {{10, 900}, {60, 900}, {60, 990}}};
    sight.now[2] = hull_of(contours, cameras[2].intrinsics);
    std::size_t num_of_2 = 0;
    for (const Tangency& t : find(cameras, sight)) {
        if (t.ends[0].camera != 2 && t.ends[1].camera != 2) continue;
        ++num_of_2;
        EXPECT_LT(std::abs(t.error_px), 60.0);
    }
    EXPECT_LT(num_of_2, 12u);
}

TEST(Tangencies, MotionIsThatOfTheOutlines) {
    const auto cameras = near_rig();
    auto points = cloud(7);
    const auto before = see(points, cameras);
    for (auto& p : points) p.z() += 0.01;
    const auto found = find(cameras, {see(points, cameras), before});
    // cameras look level: a centimetre up is about 4 px
    double most = 0.0;
    for (const Tangency& t : found) most = std::max(most, std::abs(t.motion_px));
    EXPECT_GT(most, 3.0);
    EXPECT_LT(most, 8.0);
}

TEST(Pairs, ReachAllCamerasAndStayFew) {
    for (std::size_t n = 2; n <= 64; ++n) {
        const auto pairs = pairs_of(n);
        const std::set<std::pair<std::uint32_t, std::uint32_t>> unique(pairs.begin(), pairs.end());
        EXPECT_EQ(unique.size(), pairs.size()) << n;
        if (n <= 17) {
            EXPECT_EQ(pairs.size(), n * (n - 1) / 2);
        }
        EXPECT_LE(pairs.size(), 8 * n) << n;
        std::vector<std::size_t> group(n);
        for (std::size_t i = 0; i < n; ++i) group[i] = i;
        for (std::size_t round = 0; round < n; ++round)
            for (const auto& [a, b] : pairs) {
                EXPECT_LT(a, b);
                group[a] = group[b] = std::min(group[a], group[b]);
            }
        EXPECT_EQ(std::set<std::size_t>(group.begin(), group.end()).size(), 1u) << n;
    }
}

}  // namespace
}  // namespace atrium::coherence
