#include "tests/unit/renderer/scene_renderer_fixture.hpp"

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace atrium::renderer {
namespace {

using synthetic::Sphere;

TEST_F(SceneRendererTest, TextureOnTheSurfaceMatchesTheTrueSurface) {
    const Sphere sphere{{0.0, 0.0, 1.0}, 0.5};
    const auto colour = [&](const Eigen::Vector3d& p) {
        const Eigen::Vector3d n = (p - sphere.centre) / sphere.radius_m;
        return Eigen::Vector3d(0.5 + 0.3 * std::sin(9.0 * n.x()),
                               0.5 + 0.3 * std::sin(7.0 * n.y() + 1.0),
                               0.5 + 0.3 * std::sin(8.0 * n.z() + 2.0));
    };
    std::vector<CameraPicture> pictures;
    auto cameras = synthetic::ring(8, sphere.centre);
    cameras[1].intrinsics.distortion = {-0.15, 0.03, 0.001, 0.0, 0.0};
    for (const auto& camera : cameras)
        pictures.push_back(synthetic::picture_of({sphere}, camera, colour));
    renderer_->set_person("a", person_of({sphere}, pictures));
    // the site is moved and turned in the world
    const geometry::RigidTransform world_from_site{
        Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ())), {0.4, -0.3, 0.1}};
    renderer_->set_site_pose("a", world_from_site);
    const geometry::RigidTransform site_from_world = world_from_site.inverse();

    for (const double angle : {0.1, 1.3, 2.9, 4.4}) {
        ViewCamera camera;
        camera.target_m = world_from_site * sphere.centre;
        camera.position_m =
            camera.target_m + Eigen::Vector3d(2.0 * std::cos(angle), 2.0 * std::sin(angle), 0.4);
        draw(camera);
        double worst = 0.0;
        double sum = 0.0;
        int count = 0;
        for (int y = 0; y < kHeight; y += 3) {
            for (int x = 0; x < kWidth; x += 3) {
                const Eigen::Vector3d ray = ray_of(camera, x, y);
                Eigen::Vector3d p;
                if (!synthetic::hit({sphere},
                                    site_from_world * camera.position_m,
                                    site_from_world.rotation * ray,
                                    p))
                    continue;
                const Eigen::Vector3d n = (p - sphere.centre) / sphere.radius_m;
                // away from the outline, and from the underside that no camera sees well
                if (n.dot(site_from_world.rotation * ray) > -0.35 || n.z() < -0.6) continue;
                const double error = (pixel(x, y) - colour(p)).cwiseAbs().maxCoeff();
                worst = std::max(worst, error);
                sum += error;
                ++count;
            }
        }
        ASSERT_GT(count, 1000);
        EXPECT_LT(sum / count, 0.012) << "angle " << angle;  // 3 steps of 255
        EXPECT_LT(worst, 0.10) << "angle " << angle;
    }
}

TEST_F(SceneRendererTest, HiddenPartsTakeNoColourFromBlindCameras) {
    const std::vector<Sphere> spheres = {{{0.9, 0.0, 1.0}, 0.25}, {{-0.5, 0.0, 1.0}, 0.4}};
    // the camera in line with both spheres sees a red front sphere; from the side everything is
    // green
    const Eigen::Vector3d red(0.9, 0.1, 0.1);
    const Eigen::Vector3d green(0.1, 0.8, 0.1);
    const auto front = synthetic::camera_at({3.2, 0.0, 1.0}, {0.0, 0.0, 1.0});
    const auto side = synthetic::camera_at({0.6, 3.0, 1.0}, {0.0, 0.0, 1.0});
    renderer_->set_person(
        "a",
        person_of(spheres,
                  {synthetic::picture_of(spheres, front, [&](const auto&) { return red; }),
                   synthetic::picture_of(spheres, side, [&](const auto&) { return green; })}));
    ViewCamera camera{.position_m = {1.2, 1.6, 2.1}, .target_m = {-0.4, 0.0, 1.0}};
    draw(camera);
    // on the back sphere, where the front sphere hides it from the front camera
    const Eigen::Vector3d hidden =
        spheres[1].centre + 0.4 * Eigen::Vector3d(0.9, 0.42, 0.1).normalized();
    const Eigen::Vector3d seen =
        spheres[0].centre + 0.25 * Eigen::Vector3d(0.9, 0.3, 0.3).normalized();
    EXPECT_LT((pixel_at(camera, hidden) - green).cwiseAbs().maxCoeff(), 0.06)
        << pixel_at(camera, hidden).transpose();
    EXPECT_GT(pixel_at(camera, seen).x(), 0.5);  // the red sphere is in the picture
}

TEST_F(SceneRendererTest, ObjectsAppearAtTheirPlaces) {
    ViewCamera camera{.position_m = {4.0, -2.0, 2.0}, .target_m = {0.0, 0.0, 0.5}};
    draw(camera);
    const RenderedPicture empty = picture_;
    const ShapeKind kinds[] = {
        ShapeKind::kBox, ShapeKind::kSphere, ShapeKind::kCylinder, ShapeKind::kCapsule};
    for (std::uint32_t i = 0; i < 4; ++i) {
        ObjectLook look{.shape = kinds[i], .size_m = {0.3, 0.3, 0.6}, .colour = {0.8, 0.05, 0.05}};
        look.world_from_object.translation = {0.0, 1.2 * i - 1.8, 0.5};
        renderer_->set_object(i, look);
    }
    draw(camera);
    EXPECT_EQ(renderer_->num_objects(), 4u);
    for (std::uint32_t i = 0; i < 4; ++i) {
        const Eigen::Vector3d c = pixel_at(camera, {0.0, 1.2 * i - 1.8, 0.5});
        EXPECT_GT(c.x(), 2.0 * c.y()) << "object " << i << ": " << c.transpose();
        // only the ball ends at its radius above its middle
        const Eigen::Vector3d above = pixel_at(camera, {0.0, 1.2 * i - 1.8, 0.5 + 0.22});
        EXPECT_EQ(above.x() > 2.0 * above.y(), kinds[i] != ShapeKind::kSphere) << "object " << i;
    }
    renderer_->move_object(1, {Eigen::Quaterniond::Identity(), {0.0, 0.0, 1.4}});
    draw(camera);
    EXPECT_GT(pixel_at(camera, {0.0, 0.0, 1.4}).x(), 2.0 * pixel_at(camera, {0.0, 0.0, 1.4}).y());
    for (std::uint32_t i = 0; i < 4; ++i) renderer_->remove_object(i);
    draw(camera);
    EXPECT_EQ(picture_.rgba, empty.rgba);
}

TEST_F(SceneRendererTest, ObjectShadesTheFloorBelowIt) {
    ViewCamera camera{.position_m = {0.0, -3.0, 3.0}, .target_m = {0.0, 0.0, 0.0}};
    draw(camera);
    const Eigen::Vector3d bright = pixel_at(camera, {0.02, 0.02, 0.0});
    ObjectLook look{.shape = ShapeKind::kBox, .size_m = {0.5, 0.5, 0.05}};
    look.world_from_object.translation = {0.0, 0.0, 1.0};
    renderer_->set_object(7, look);
    draw(camera);
    // the light comes from (0.30, -0.22, 1), and the shadow falls to the other side
    const Eigen::Vector3d shaded = pixel_at(camera, {-0.30, 0.22, 0.0});
    EXPECT_LT(shaded.x(), 0.8 * bright.x());
    EXPECT_GT(shaded.x(), 0.5 * bright.x());
}

TEST_F(SceneRendererTest, RemovedPersonLeavesNoTraces) {
    ViewCamera camera;
    draw(camera);
    const RenderedPicture empty = picture_;
    const Sphere sphere{{0.0, 0.0, 1.0}, 0.5};
    renderer_->set_person("a", person_of({sphere}, {}));
    draw(camera);
    EXPECT_EQ(renderer_->num_people(), 1u);
    EXPECT_NE(picture_.rgba, empty.rgba);
    renderer_->remove_person("a");
    draw(camera);
    EXPECT_EQ(renderer_->num_people(), 0u);
    EXPECT_EQ(picture_.rgba, empty.rgba);
}

TEST_F(SceneRendererTest, NewModelReplacesAndReturnsTheOldOne) {
    ViewCamera camera;
    renderer_->set_person("a", person_of({{{0.0, 0.0, 1.0}, 0.5}}, {}));
    draw(camera);
    const PersonModel former = renderer_->set_person("a", person_of({{{0.0, 0.0, 3.0}, 0.2}}, {}));
    EXPECT_FALSE(former.triangles.empty());
    draw(camera);
    EXPECT_GT((pixel_at(camera, {0.0, 0.0, 1.0}) - Eigen::Vector3d::Constant(0.5)).norm(), 0.1);
}

TEST_F(SceneRendererTest, SupportsTwentyCamerasAndChangingNumbers) {
    const Sphere sphere{{0.0, 0.0, 1.0}, 0.5};
    const Eigen::Vector3d blue(0.1, 0.2, 0.9);
    std::vector<CameraPicture> pictures;
    for (const auto& camera : synthetic::ring(20, sphere.centre))
        pictures.push_back(
            synthetic::picture_of({sphere}, camera, [&](const auto&) { return blue; }));
    ViewCamera camera;
    for (const std::size_t count : {20u, 3u, 11u}) {
        pictures.resize(std::min<std::size_t>(pictures.size(), count));
        renderer_->set_person("a", person_of({sphere}, pictures));
        draw(camera);
        EXPECT_LT((pixel_at(camera, sphere.centre) - blue).cwiseAbs().maxCoeff(), 0.02) << count;
    }
}

TEST_F(SceneRendererTest, ResizesItsPicture) {
    ASSERT_TRUE(renderer_->resize(200, 100));
    draw({});
    EXPECT_EQ(picture_.width, 200);
    EXPECT_EQ(picture_.height, 100);
    EXPECT_EQ(picture_.rgba.size(), 200u * 100u * 4u);
    EXPECT_GT(pixel(100, 5).z(), 0.3);  // sky, not black
}

TEST_F(SceneRendererTest, SmoothingSoftensEdgesAndKeepsFlatColours) {
    auto smoothed =
        SceneRenderer::create({.width = kWidth, .height = kHeight, .antialias = Antialias::kFxaa});
    ASSERT_TRUE(smoothed) << smoothed.error().message;
    ObjectLook look{.shape = ShapeKind::kBox, .colour = {0.0, 0.0, 0.0}};
    look.world_from_object.rotation = Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 1, 0).normalized());
    look.world_from_object.translation.z() = 1.0;
    const ViewCamera camera;
    renderer_->set_object(0, look);
    smoothed->set_object(0, look);
    draw(camera);
    const RenderedPicture hard = picture_;
    smoothed->draw(camera);
    smoothed->read_pixels(picture_);
    int num_different = 0;
    for (std::size_t i = 0; i < hard.rgba.size(); i += 4)
        num_different += hard.rgba[i] != picture_.rgba[i];
    EXPECT_GT(num_different, 100);
    EXPECT_LT(num_different, kWidth * kHeight / 10);
}

TEST_F(SceneRendererTest, SoftOutlinesStayBehindObjects) {
    auto hard =
        SceneRenderer::create({.width = kWidth, .height = kHeight, .has_soft_outlines = false});
    ASSERT_TRUE(hard) << hard.error().message;
    const synthetic::Sphere sphere{{0.0, 0.0, 1.0}, 0.5};
    std::vector<CameraPicture> pictures;
    for (const auto& camera : synthetic::ring(6, sphere.centre))
        pictures.push_back(synthetic::picture_of(
            {sphere}, camera, [](const auto&) { return Eigen::Vector3d(0.9, 0.1, 0.1); }));
    const ViewCamera camera{.position_m = {3, 0, 1}, .target_m = {0, 0, 1}, .fov_deg = 30.0};
    // hides the left half
    ObjectLook wall{.shape = ShapeKind::kBox, .colour = {0.1, 0.2, 0.8}};
    wall.size_m = {0.1, 1.0, 2.0};
    wall.world_from_object.translation = {0.8, -0.5, 1.0};
    const auto show = [&](SceneRenderer& renderer) {
        renderer.set_person("a", person_of({{sphere.centre, 0.49}}, pictures));
        renderer.set_object(0, wall);
        renderer.draw(camera);
        renderer.read_pixels(picture_);
        return picture_;
    };
    const RenderedPicture without = show(*hard);
    const RenderedPicture with = show(*renderer_);
    int num_left = 0;
    int num_right = 0;
    for (std::size_t i = 0; i < with.rgba.size(); i += 4) {
        if (std::equal(&with.rgba[i], &with.rgba[i] + 3, &without.rgba[i])) continue;
        ++(static_cast<int>(i / 4) % kWidth < kWidth / 2 ? num_left : num_right);
        EXPECT_LT(with.rgba[i + 2], without.rgba[i + 2]) << "red over the floor and the sky";
    }
    EXPECT_EQ(std::min(num_left, num_right), 0);
    EXPECT_GT(std::max(num_left, num_right), 100);
}

TEST_F(SceneRendererTest, DrawsASoftClothFromBothSidesAndARope) {
    const ViewCamera front{.position_m = {0, -3, 1}, .target_m = {0, 0, 1}, .fov_deg = 45.0};
    const ViewCamera back{.position_m = {0, 3, 1}, .target_m = {0, 0, 1}, .fov_deg = 45.0};
    draw(front);
    const Eigen::Vector3d before = pixel_at(front, {0.1, 0, 1});
    const SoftLook look{.num_nodes = 6,
                        .triangles = {{0, 1, 2}, {0, 2, 3}},
                        .segments = {{4, 5}},
                        .thickness_m = 0.06,
                        .colour = {0.8, 0.05, 0.05}};
    renderer_->set_soft_object(3, look);
    draw(front);
    EXPECT_EQ(pixel_at(front, {0.1, 0, 1}), before)
        << "the cloth must stay hidden until its nodes are known";

    std::vector<Eigen::Vector3f> nodes{{-0.4F, 0, 0.6F},
                                       {0.4F, 0, 0.6F},
                                       {0.4F, 0, 1.4F},
                                       {-0.4F, 0, 1.4F},
                                       {0.7F, 0, 0.5F},
                                       {0.7F, 0, 1.5F}};
    renderer_->move_soft_object(3, nodes);
    for (const ViewCamera& camera : {front, back}) {
        draw(camera);
        for (const Eigen::Vector3d& p : {Eigen::Vector3d(0.1, 0, 1), {-0.3, 0, 0.8}, {0.7, 0, 1}}) {
            const Eigen::Vector3d colour = pixel_at(camera, p);
            EXPECT_GT(colour.x(), 2.0 * colour.y()) << p.transpose();
            EXPECT_GT(colour.x(), 0.3) << "both sides must be lit";
        }
    }
    for (Eigen::Vector3f& node : nodes) node.x() += 2.0F;
    renderer_->move_soft_object(3, nodes);
    draw(front);
    EXPECT_LT(pixel_at(front, {-0.3, 0, 0.8}).x(), 2.0 * pixel_at(front, {-0.3, 0, 0.8}).y())
        << "the cloth must have moved away";
    nodes.pop_back();
    renderer_->move_soft_object(3, nodes);  // a different number of nodes is ignored
    renderer_->remove_soft_object(3);
    EXPECT_EQ(renderer_->num_objects(), 0U);
}

TEST_F(SceneRendererTest, DrawsAModelInPlaceOfAShapeAndScenery) {
    const ViewCamera camera{.position_m = {0, -3, 1}, .target_m = {0, 0, 1}, .fov_deg = 45.0};
    // a flat triangle, which a box of the object's size would cover
    auto mesh = std::make_shared<ShapeMesh>();
    for (const Eigen::Vector3f& p :
         {Eigen::Vector3f(-0.4F, 0, -0.4F), {0.4F, 0, -0.4F}, {-0.4F, 0, 0.4F}})
        mesh->corners.push_back({p, {0, -1, 0}});
    mesh->indices = {0, 1, 2};
    ObjectLook look{.model = mesh,
                    .size_m = {0.8, 0.8, 0.8},
                    .colour = {0.05, 0.7, 0.05},
                    .world_from_object = {Eigen::Quaterniond::Identity(), {0, 0, 1}}};
    const auto is_green = [&](const Eigen::Vector3d& p) {
        const Eigen::Vector3d colour = pixel_at(camera, p);
        return colour.y() > 1.5 * colour.x();
    };
    renderer_->set_object(1, look);
    draw(camera);
    EXPECT_TRUE(is_green({-0.2, 0, 0.8}));
    EXPECT_FALSE(is_green({0.3, 0, 1.3})) << "the model does not fill this half of the box";
    renderer_->remove_object(1);

    renderer_->set_object(1, {.shape = ShapeKind::kPlane, .size_m = {8, 8, 0}});
    renderer_->set_scenery("room", std::vector{look});
    draw(camera);
    EXPECT_TRUE(is_green({-0.2, 0, 0.8}));
    const RenderedPicture shaded = picture_;
    renderer_->set_scenery("room", {});
    draw(camera);
    EXPECT_GT(num_darker(shaded, picture_, kHeight * 2 / 3), 100)
        << "the shadow on the floor is missing";
    const RenderedPicture bare = picture_;
    // a roof over everything
    mesh = std::make_shared<ShapeMesh>(*mesh);
    for (ShapeMesh::Corner& corner : mesh->corners) corner.position_object *= 20.0F;
    look.model = mesh;
    look.world_from_object.rotation =
        Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitX());
    look.world_from_object.translation = {0, 0, 3};
    renderer_->set_scenery("room", std::vector{look});
    draw(camera);
    EXPECT_EQ(num_darker(picture_, bare, kHeight * 2 / 3), 0) << "a roof must cast no shadow";
    renderer_->set_scenery("room", {});
    draw(camera);
    EXPECT_FALSE(is_green({-0.2, 0, 0.8}));
}

}  // namespace
}  // namespace atrium::renderer
