#include "site_node/refine/surfels.hpp"

#include "site_node/hull/visual_hull.hpp"
#include "tests/support/random.hpp"
#include "tests/support/shapes/box_mesh.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/silhouette_maker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

namespace atrium::refine {
namespace {

constexpr double kRadius_m = 0.3;
const Eigen::Vector3d kCentre(0.1, -0.2, 0.9);

struct Ball {
    std::vector<geometry::CalibratedCamera> rig = test::make_ring_rig({.num_cameras = 8});
    std::vector<Eigen::Vector3d> centres;
    geometry::TriangleMesh hull;

    Ball() {
        std::vector<hull::SilhouetteView> views;
        for (const geometry::CalibratedCamera& camera : rig) {
            views.push_back({camera.intrinsics, camera.camera_from_site, {}, {}});
            views.back().contours.push_back(
                test::outline_of(test::Sphere{kCentre, kRadius_m}, camera, 60));
            centres.push_back(camera.centre_site());
        }
        hull::HullScratch scratch;
        hull = hull::compute_visual_hull(views, {}, scratch).mesh;
    }
};

class SurfelsOfABall : public testing::Test {
protected:
    void SetUp() override { surfels_.sample(ball_.hull, ball_.centres, options_, executor_); }

    Ball ball_;
    SurfelOptions options_;
    SerialExecutor executor_;
    Surfels surfels_;
};

TEST_F(SurfelsOfABall, LieOnItEvenly) {
    const double area = 4.0 * 3.1416 * kRadius_m * kRadius_m;
    const double spacing = double{options_.spacing_m};
    EXPECT_GT(static_cast<double>(surfels_.size()), 0.7 * area / (spacing * spacing));
    EXPECT_LT(static_cast<double>(surfels_.size()), 3.0 * area / (spacing * spacing));
    for (std::size_t i = 0; i < surfels_.size(); ++i) {
        const Eigen::Vector3f out = surfels_[i].position_site - kCentre.cast<float>();
        EXPECT_GT(out.norm(), kRadius_m - 0.01);
        EXPECT_LT(out.norm(), 1.35 * kRadius_m);
        EXPECT_GT(out.normalized().dot(surfels_[i].normal), 0.75F);
        EXPECT_NEAR(surfels_[i].normal.norm(), 1.0F, 1e-5F);
    }
    // each point of the surface is near to one
    for (const Eigen::Vector3d& vertex : ball_.hull.vertices) {
        float nearest = 1.0F;
        for (std::size_t i = 0; i < surfels_.size(); ++i)
            nearest = std::min(nearest, (surfels_[i].position_site - vertex.cast<float>()).norm());
        EXPECT_LT(nearest, 1.8F * options_.spacing_m);
    }
}

TEST_F(SurfelsOfABall, KnowTheCameraWhoseOutlineMadeThem) {
    std::set<std::int32_t> owners;
    for (std::size_t i = 0; i < surfels_.size(); ++i) {
        const std::int32_t owner = surfels_[i].owner;
        if (owner == hull::kNoOwner) continue;
        owners.insert(owner);
        // the camera sees the surface edge-on
        const Eigen::Vector3d to = (ball_.centres[static_cast<std::size_t>(owner)] -
                                    surfels_[i].position_site.cast<double>())
                                       .normalized();
        EXPECT_LT(std::abs(to.dot(surfels_[i].normal.cast<double>())), 0.5) << i;
    }
    EXPECT_EQ(owners.size(), 8U);
}

TEST_F(SurfelsOfABall, HaveNeighboursBothWays) {
    for (std::size_t i = 0; i < surfels_.size(); ++i) {
        EXPECT_GE(surfels_.neighbours(i).size(), 2U);
        for (const Surfels::Neighbour& other : surfels_.neighbours(i)) {
            EXPECT_NE(other.surfel, i);
            EXPECT_LE((surfels_[other.surfel].position_site - surfels_[i].position_site).norm(),
                      options_.neighbourhood_m);
            const auto back = surfels_.neighbours(other.surfel);
            EXPECT_TRUE(std::ranges::any_of(
                back, [&](const Surfels::Neighbour& n) { return n.surfel == i; }));
        }
    }
}

TEST(Surfels, KnowHowThickAPlateIs) {
    for (const double thickness : {0.03, 0.07, 0.15, 0.5}) {
        const geometry::TriangleMesh box = test::box_mesh({0, 0, 0}, {0.8, 0.8, thickness});
        ASSERT_TRUE(geometry::inspect(box).manifold);
        SurfelOptions options;
        SerialExecutor executor;
        Surfels surfels;
        surfels.sample(box, {}, options, executor);
        int num = 0;
        for (std::size_t i = 0; i < surfels.size(); ++i) {
            const Eigen::Vector3f& at = surfels[i].position_site;
            if (std::abs(surfels[i].normal.z()) < 0.9F || (at.head<2>().array() < 0.1F).any() ||
                (at.head<2>().array() > 0.7F).any())
                continue;
            ++num;
            EXPECT_EQ(surfels[i].owner, hull::kNoOwner);
            EXPECT_NEAR(surfels[i].thickness_m,
                        std::min(thickness, double{options.most_thickness_m}),
                        0.002);
        }
        EXPECT_GT(num, 500);
    }
}

TEST(Surfels, OfNothingAreNone) {
    SerialExecutor executor;
    Surfels surfels;
    surfels.sample({}, {}, {}, executor);
    EXPECT_EQ(surfels.size(), 0U);
}

TEST(PointGrid, FindsAllPointsWithinTheRadius) {
    test::Random random(9);
    for (const double extent : {0.01, 1.0, 2000.0}) {
        std::vector<Eigen::Vector3f> points;
        for (int i = 0; i < 300; ++i)
            points.push_back(test::random_in_cube(random, extent).cast<float>());
        PointGrid grid;
        grid.assign(points, 0.04F);
        const float radius = static_cast<float>(0.2 * extent);
        for (int i = 0; i < 40; ++i) {
            const Eigen::Vector3f centre = test::random_in_cube(random, 1.2 * extent).cast<float>();
            std::vector<int> visits(points.size(), 0);
            grid.near(centre, radius, [&](std::uint32_t begin, std::uint32_t end) {
                for (std::uint32_t place = begin; place < end; ++place)
                    ++visits[grid.order()[place]];
            });
            for (std::size_t k = 0; k < points.size(); ++k) {
                EXPECT_LE(visits[k], 1);
                if ((points[k] - centre).norm() <= radius) {
                    EXPECT_EQ(visits[k], 1);
                }
            }
        }
    }
}

}  // namespace
}  // namespace atrium::refine
