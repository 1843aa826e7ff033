#include "core/base/executor.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "site_node/hull_stage.hpp"
#include "site_node/silhouette_stage/silhouette_stage.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/unit/site_node/capsule_room.hpp"

#include <gtest/gtest.h>

namespace atrium::site_node {
namespace {

// The hull of `body` seen by a ring of cameras.
hull::VisualHull hull_of(const std::vector<test::Capsule>& body,
                         int num_cameras,
                         bool keep_phantoms,
                         std::vector<geometry::CalibratedCamera>* rig = nullptr) {
    const auto cameras = atrium::test::make_ring_rig(
        {.num_cameras = num_cameras, .radius_m = 4.0, .size_px = 400, .focal_px = 380.0});
    HullStageOptions options;
    options.keep_phantoms = keep_phantoms;
    options.bounds = geometry::Aabb{{-1.6, -1.6, -0.1}, {1.6, 1.6, 2.2}};
    auto stage = HullStage::create(cameras, options, 1.0);
    EXPECT_TRUE(stage);
    for (std::size_t c = 0; c < cameras.size(); ++c) {
        SilhouetteStage silhouettes(cameras[c], {});
        PictureSilhouette found;
        capture::CameraFrame frame;
        auto image = std::make_shared<image::YuvImage>();
        image->y = image::Plane(400, 400);
        image->u = image->v = image::Plane(200, 200);
        frame.image = image::RawImage(std::move(image));
        frame.silhouette = std::make_shared<image::Mask>(test::draw(body, cameras[c]));
        EXPECT_TRUE(silhouettes.find(frame, {}, found));
        stage->contours(c) = found.contours;
    }
    SerialExecutor executor;
    hull::VisualHull hull;
    stage->compute(std::vector<std::uint8_t>(cameras.size(), 1), executor, hull);
    if (rig != nullptr) *rig = cameras;
    return hull;
}

std::vector<test::Capsule> people(std::initializer_list<Eigen::Vector3d> places) {
    std::vector<test::Capsule> all;
    for (const Eigen::Vector3d& place : places) {
        const auto body = test::make_body(place);
        all.insert(all.end(), body.begin(), body.end());
    }
    return all;
}

TEST(WeakComponents, LeavesOnlyThePeopleOfACrowd) {
    const auto crowd = people({{0.8, 0.7, 0}, {-0.8, 0.75, 0}, {0.75, -0.8, 0}, {-0.7, -0.75, 0}});
    const auto all = hull_of(crowd, 4, true);
    const auto kept = hull_of(crowd, 4, false);
    ASSERT_EQ(kept.status, hull::HullStatus::kOk);
    EXPECT_GT(inspect(all.mesh).num_components, 4u);
    const auto report = inspect(kept.mesh);
    EXPECT_TRUE(report.closed);
    EXPECT_TRUE(report.manifold);
    EXPECT_EQ(report.num_components, kept.num_components);
    EXPECT_LT(kept.num_components, inspect(all.mesh).num_components);
    EXPECT_GT(report.volume_m3, 0.9 * geometry::volume_m3(all.mesh));
    const geometry::Aabb before = bounds(all.mesh);
    const geometry::Aabb after = bounds(kept.mesh);
    EXPECT_LT((before.size() - after.size()).norm(), 0.1);
}

// A ball in the air explains pixels that nobody else explains.
TEST(WeakComponents, KeepsASmallThingThatSilhouettesNeed) {
    auto scene = people({{0.5, 0.4, 0}});
    scene.push_back({{-0.6, -0.5, 1.5}, {-0.6, -0.5, 1.51}, 0.07});
    const auto hull = hull_of(scene, 6, false);
    ASSERT_EQ(hull.status, hull::HullStatus::kOk);
    bool has_ball = false;
    for (const Eigen::Vector3d& v : hull.mesh.vertices)
        has_ball = has_ball || (v - Eigen::Vector3d(-0.6, -0.5, 1.5)).norm() < 0.12;
    EXPECT_TRUE(has_ball);
}

TEST(WeakComponents, DoesNotTouchASinglePerson) {
    const auto one = people({{0.1, 0.0, 0}});
    const auto all = hull_of(one, 6, true);
    const auto kept = hull_of(one, 6, false);
    EXPECT_NEAR(geometry::volume_m3(kept.mesh), geometry::volume_m3(all.mesh), 1e-4);
}

}  // namespace
}  // namespace atrium::site_node
