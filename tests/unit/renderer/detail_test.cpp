// The renderer draws objects that are small in the picture with fewer triangles, and objects out of
// sight not at all.
#include "tests/unit/renderer/scene_renderer_fixture.hpp"
#include "viewer/renderer/backdrop/backdrop.hpp"
#include "viewer/renderer/person/person_drawing.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

namespace atrium::renderer {
namespace {

double volume(const ShapeMesh& mesh, const std::vector<std::uint32_t>& indices) {
    double sum = 0.0;
    for (std::size_t i = 0; i < indices.size(); i += 3) {
        const auto at = [&](std::size_t k) {
            return Eigen::Vector3d(mesh.corners[indices[i + k]].position_object.cast<double>());
        };
        sum += at(0).dot(at(1).cross(at(2))) / 6.0;
    }
    return sum;
}

TEST(ShapeMesh, CoarserLevelsKeepTheSolidWithAQuarterOfTheTriangles) {
    for (const ShapeKind kind : {ShapeKind::kSphere, ShapeKind::kCapsule, ShapeKind::kCylinder}) {
        const ShapeMesh mesh = make_shape(kind, {0.4, 0.4, 1.0});
        const double whole = volume(mesh, mesh.indices);
        // a polygon of 16 sides has 0.974 of its circle's area, one of 8 sides 0.900; balls lose
        // more
        EXPECT_GT(volume(mesh, mesh.coarser[0]), 0.94 * whole);
        EXPECT_GT(volume(mesh, mesh.coarser[1]), 0.75 * whole);
        EXPECT_LT(volume(mesh, mesh.coarser[0]), whole);
        EXPECT_LE(mesh.coarser[0].size(), mesh.indices.size() / 2);
        EXPECT_LE(mesh.coarser[1].size(), mesh.coarser[0].size() / 2);
    }
    EXPECT_TRUE(make_shape(ShapeKind::kBox, {1, 1, 1}).coarser[0].empty());
}

TEST(SeenRadius, IsZeroOnlyIfNoPointOfTheBallIsInSight) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> place(-6.0, 6.0);
    const ViewCamera camera;
    const EyeView eye = eye_of(camera, kWidth, kHeight);
    const View view{eye.clip_from_world(), eye.eye_world(), kHeight};
    int num_out_of_sight = 0;
    for (int i = 0; i < 500; ++i) {
        const Eigen::Vector3d centre(place(random), place(random), place(random));
        const double radius_m = std::abs(place(random)) / 6.0;
        const double seen_px = seen_radius_px(view, centre, radius_m);
        num_out_of_sight += seen_px == 0.0 ? 1 : 0;
        for (int k = 0; k < 100 && seen_px == 0.0; ++k) {
            const Eigen::Vector3d direction =
                Eigen::Vector3d(place(random), place(random), place(random)).normalized();
            const Eigen::Vector4d clip =
                view.clip_from_world * (centre + radius_m * direction).homogeneous();
            EXPECT_GT(clip.head<3>().cwiseAbs().maxCoeff(), clip.w()) << centre.transpose();
        }
    }
    EXPECT_GT(num_out_of_sight, 100);
    EXPECT_LT(num_out_of_sight, 490);
}

TEST(SeenRadius, IsTheRadiusOfTheBallsOutline) {
    const ViewCamera camera;
    const EyeView eye = eye_of(camera, kWidth, kHeight);
    const View view{eye.clip_from_world(), eye.eye_world(), kHeight};
    const double distance_m = (camera.target_m - camera.position_m).norm();
    const Eigen::Vector3d up = eye.view_from_world.row(1).head<3>();
    const double half_px = (project_px(camera, camera.target_m + 0.05 * up, kWidth, kHeight) -
                            project_px(camera, camera.target_m, kWidth, kHeight))
                               .norm();
    EXPECT_NEAR(seen_radius_px(view, camera.target_m, 0.05),
                half_px * distance_m / (distance_m - 0.05),
                0.01);
    EXPECT_GT(seen_radius_px(view, camera.position_m, 1.0), kHeight);
}

// An object can cast a shadow into the picture from outside.
TEST_F(SceneRendererTest, ObjectsOutOfSightCastShadows) {
    ViewCamera camera;
    camera.position_m = {0.0, -2.0, 1.2};
    camera.target_m = {0.0, 0.0, 0.0};
    renderer_->set_object(1, {.shape = ShapeKind::kPlane, .size_m = {8, 8, 0}});
    draw(camera);
    const RenderedPicture bare = picture_;
    ObjectLook high{.shape = ShapeKind::kSphere, .size_m = {0.6, 0.6, 0.6}};
    high.world_from_object.translation = {0.0, 0.0, 3.0};
    renderer_->set_object(2, high);
    draw(camera);
    EXPECT_GT(num_darker(picture_, bare), 500);
}

// The person's shadow on the floor ends where the light rays past the person end.
TEST_F(SceneRendererTest, PersonShadowHasTheShapeOfTheSurface) {
    const synthetic::Sphere sphere{{0.0, 0.0, 1.0}, 0.3};
    const geometry::RigidTransform world_from_site{Eigen::Quaterniond::Identity(),
                                                   {0.4, -0.3, 1.0}};
    ViewCamera camera;
    camera.position_m = {0.0, -0.5, 7.0};
    camera.target_m = {0.0, 0.0, 0.0};
    renderer_->set_object(1, {.shape = ShapeKind::kPlane, .size_m = {8, 8, 0}});
    draw(camera);
    const auto brightness = [this](int x, int y) { return pixel(x, y).mean(); };
    std::vector<double> bare;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) bare.push_back(brightness(x, y));
    renderer_->set_site_pose("a", world_from_site);
    renderer_->set_person("a", person_of({sphere}, {}));
    draw(camera);
    const Eigen::Vector3d light = light_world().cast<double>();
    const Eigen::Vector3d centre = world_from_site * sphere.centre;
    int num_checked = 0;
    for (int y = 0; y < kHeight; y += 2) {
        for (int x = 0; x < kWidth; x += 2) {
            const Eigen::Vector3d ray = ray_of(camera, x, y);
            const Eigen::Vector3d p = camera.position_m - ray * (camera.position_m.z() / ray.z());
            if (p.head<2>().cwiseAbs().maxCoeff() > 3.5) continue;
            // the person hides it
            if ((centre - camera.position_m).cross(ray).norm() < 0.4) continue;
            const double distance_m = (centre - p).cross(light).norm();
            const double darker = bare[static_cast<std::size_t>(y * kWidth + x)] - brightness(x, y);
            if (distance_m > sphere.radius_m + 0.08) {
                EXPECT_NEAR(darker, 0.0, 0.005) << p.transpose();
            }
            if (distance_m < sphere.radius_m - 0.08) {
                EXPECT_GT(darker, 0.04) << p.transpose();
                ++num_checked;
            }
        }
    }
    EXPECT_GT(num_checked, 50);
}

// The objects share their meshes and one draw call, but each has its own place, size and colour.
TEST_F(SceneRendererTest, DrawsEachOfManyObjectsAtItsPlace) {
    ViewCamera camera;
    camera.position_m = {0.0, -0.5, 7.0};  // no object hides another
    camera.target_m = {0.0, 0.0, 0.0};
    constexpr std::array kKinds = {ShapeKind::kBox, ShapeKind::kCylinder, ShapeKind::kCapsule};
    const std::array<Eigen::Vector3d, 3> colours = {
        Eigen::Vector3d{0.9, 0.05, 0.05}, {0.05, 0.9, 0.05}, {0.05, 0.05, 0.9}};
    std::vector<std::pair<Eigen::Vector3d, Eigen::Index>> places;  // of tops, and their colours
    for (std::uint32_t i = 0; i < 360; ++i) {
        const double size_m = 0.05 + 0.03 * (i % 4);
        ObjectLook look{.shape = kKinds[i % 3], .size_m = {size_m, size_m, 2.0 * size_m}};
        const Eigen::Index colour = (i / 3) % 3;
        look.colour = colours[static_cast<std::size_t>(colour)];
        look.world_from_object.translation = {
            0.2 * (i % 20) - 1.9, 0.22 * static_cast<double>(i / 20) - 2.0, size_m};
        renderer_->set_object(i + 1, look);
        places.emplace_back(look.world_from_object.translation, colour);
    }
    draw(camera);
    for (const auto& [place, colour] : places) {
        const Eigen::Vector3d seen = pixel_at(camera, place);
        Eigen::Index most = 0;
        EXPECT_GT(seen.maxCoeff(&most), 0.15);
        EXPECT_EQ(most, colour) << place.transpose() << ": " << seen.transpose();
        EXPECT_GT(seen.maxCoeff(), 2.0 * seen.minCoeff());
    }
}

}  // namespace
}  // namespace atrium::renderer
