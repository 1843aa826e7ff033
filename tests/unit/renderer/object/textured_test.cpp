// Texture coordinates of each shape, and their pictures on screen.
#include "core/gl/offscreen_context.hpp"
#include "viewer/renderer/scene_renderer.hpp"

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

namespace atrium::renderer {
namespace {

// Texture coordinates of the corner nearest to a point of the surface, among the corners that face
// along `normal`.
Eigen::Vector2f place_at(const ShapeMesh& mesh,
                         const Eigen::Vector3f& p,
                         const Eigen::Vector3f& normal) {
    const ShapeMesh::Corner* nearest = nullptr;
    for (const ShapeMesh::Corner& corner : mesh.corners) {
        if (corner.normal_object.dot(normal.normalized()) < 0.9F) continue;
        if (nearest == nullptr ||
            (corner.position_object - p).norm() < (nearest->position_object - p).norm())
            nearest = &corner;
    }
    EXPECT_NE(nearest, nullptr);
    return nearest == nullptr ? Eigen::Vector2f::Zero() : nearest->texture_place;
}

MATCHER_P2(IsPlace, u, v, "") {
    return std::abs(arg.x() - u) < 1e-4 && std::abs(arg.y() - v) < 1e-4;
}

TEST(TexturePlaces, CoverEachFaceOfABoxUpright) {
    const ShapeMesh box = make_shape(ShapeKind::kBox, {0.4, 0.6, 0.8});
    for (const Eigen::Vector3f& normal : {Eigen::Vector3f::UnitX().eval(),
                                          Eigen::Vector3f(-1, 0, 0),
                                          Eigen::Vector3f(0, 1, 0),
                                          Eigen::Vector3f(0, -1, 0)}) {
        // seen from outside with +z up
        const Eigen::Vector3f right = Eigen::Vector3f::UnitZ().cross(normal);
        const Eigen::Vector3f up = Eigen::Vector3f::UnitZ();
        EXPECT_THAT(place_at(box, normal - right + up, normal), IsPlace(0, 0));
        EXPECT_THAT(place_at(box, normal + right + up, normal), IsPlace(1, 0));
        EXPECT_THAT(place_at(box, normal + right - up, normal), IsPlace(1, 1));
        EXPECT_THAT(place_at(box, normal - right - up, normal), IsPlace(0, 1));
    }
    EXPECT_THAT(place_at(box, {-1, 1, 1}, {0, 0, 1}), IsPlace(0, 0));
    EXPECT_THAT(place_at(box, {1, -1, 1}, {0, 0, 1}), IsPlace(1, 1));
}

TEST(TexturePlaces, WrapASphereFromTopToBottom) {
    const ShapeMesh ball = make_shape(ShapeKind::kSphere, {1, 1, 1});
    EXPECT_THAT(place_at(ball, {0, 0.5F, 0}, {0, 1, 0}), IsPlace(0.25, 0.5));
    EXPECT_THAT(place_at(ball, {-0.5F, 0, 0}, {-1, 0, 0}), IsPlace(0.5, 0.5));
    EXPECT_NEAR(place_at(ball, {0, 0, 0.5F}, {0, 0, 1}).y(), 0.0F, 1e-4F);
    EXPECT_NEAR(place_at(ball, {0, 0, -0.5F}, {0, 0, -1}).y(), 1.0F, 1e-4F);
}

TEST(TexturePlaces, WrapACylinderAndCrossItsEnds) {
    const ShapeMesh cylinder = make_shape(ShapeKind::kCylinder, {0.4, 0.4, 1.0});
    EXPECT_THAT(place_at(cylinder, {0, 0.2F, 0.5F}, {0, 1, 0}), IsPlace(0.25, 0));
    EXPECT_THAT(place_at(cylinder, {0, 0.2F, -0.5F}, {0, 1, 0}), IsPlace(0.25, 1));
    EXPECT_THAT(place_at(cylinder, {0, 0, 0.5F}, {0, 0, 1}), IsPlace(0.5, 0.5));
    EXPECT_THAT(place_at(cylinder, {0.2F, 0, 0.5F}, {0, 0, 1}), IsPlace(1, 0.5));
    EXPECT_THAT(place_at(cylinder, {0, 0.2F, 0.5F}, {0, 0, 1}), IsPlace(0.5, 0));
}

TEST(TexturePlaces, RunEvenlyAlongACapsule) {
    // 0.2 pi + 0.6 m from pole to pole, of which the straight part is 0.6 m
    const ShapeMesh capsule = make_shape(ShapeKind::kCapsule, {0.4, 0.4, 1.0});
    const double length = 0.2 * std::numbers::pi + 0.6;
    EXPECT_THAT(place_at(capsule, {0, 0.2F, 0.3F}, {0, 1, 0}),
                IsPlace(0.25, 0.1 * std::numbers::pi / length));
    EXPECT_THAT(place_at(capsule, {0, 0.2F, -0.3F}, {0, 1, 0}),
                IsPlace(0.25, 1.0 - 0.1 * std::numbers::pi / length));
    EXPECT_NEAR(place_at(capsule, {0, 0, -0.5F}, {0, 0, -1}).y(), 1.0F, 1e-4F);
}

TEST(TexturePlaces, RepeatPerMetreOnAPlaneAndOnModelsWithout) {
    const ShapeMesh plane = make_shape(ShapeKind::kPlane, {4, 6, 0});
    EXPECT_THAT(place_at(plane, {2, 3, 0}, {0, 0, 1}), IsPlace(2, -3));
    EXPECT_THAT(projected_place({0.3F, 0.5F, 0.7F}, {0.1F, 0.2F, 0.9F}), IsPlace(0.3, -0.5));
    EXPECT_THAT(projected_place({0.3F, 0.5F, 0.7F}, {0.9F, 0.2F, 0.1F}), IsPlace(0.5, -0.7));
    EXPECT_THAT(projected_place({0.3F, 0.5F, 0.7F}, {0.1F, -0.9F, 0.1F}), IsPlace(0.3, -0.7));
}

TEST(TexturePlaces, CoverAClothOnceInAnyPose) {
    // three columns and two rows, whose diagonals alternate
    const SoftLook cloth{.num_nodes = 6, .triangles = {{0, 4, 1}, {0, 3, 4}, {1, 4, 2}, {2, 4, 5}}};
    const std::vector<Eigen::Vector3f> crumpled(6, Eigen::Vector3f(1, 2, 3));
    const auto places = make_texture_places(cloth, crumpled);
    ASSERT_EQ(places.size(), 6U);
    EXPECT_THAT(places[0], IsPlace(0, 0));
    EXPECT_THAT(places[1], IsPlace(0.5, 0));
    EXPECT_THAT(places[5], IsPlace(1, 1));
}

TEST(TexturePlaces, WrapASoftBall) {
    const SoftLook ball{.num_nodes = 4, .triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}};
    const std::vector<Eigen::Vector3f> nodes{{3, 0, 0}, {1, 0, 0}, {2, 0, 1}, {2, 0, -1}};
    const auto places = make_texture_places(ball, nodes);
    ASSERT_EQ(places.size(), 4U);
    EXPECT_THAT(places[0], IsPlace(0.5, 0.5));
    EXPECT_NEAR(places[2].y(), 0.0F, 1e-4F);
    EXPECT_NEAR(places[3].y(), 1.0F, 1e-4F);
}

// Red, green / blue, transparent: one quarter each.
TexturePicture quarters() {
    TexturePicture picture{.width = 64, .height = 64, .rgba = {}};
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            const bool right = x >= 32, low = y >= 32;
            for (const bool value : {!right && !low, right && !low, !right && low, !(right && low)})
                picture.rgba.push_back(value ? 255 : 0);
        }
    }
    return picture;
}

class TexturedTest : public testing::Test {
protected:
    void SetUp() override {
        auto context = gl::OffscreenContext::create(16, 16);
        ASSERT_TRUE(context) << context.error().message;
        context_.emplace(std::move(*context));
        auto renderer = SceneRenderer::create({.width = 480, .height = 360});
        ASSERT_TRUE(renderer) << renderer.error().message;
        renderer_.emplace(std::move(*renderer));
    }
    void TearDown() override { renderer_.reset(); }

    // Returns 'r', 'g' or 'b' if that colour exceeds both others by half, otherwise '.'.
    char hue_at(const Eigen::Vector3d& p_world) const {
        const Eigen::Vector2d px = project_px(camera_, p_world, picture_.width, picture_.height);
        const auto i = 4 * (static_cast<std::size_t>(std::lround(px.y())) * 480 +
                            static_cast<std::size_t>(std::lround(px.x())));
        const int r = picture_.rgba[i], g = picture_.rgba[i + 1], b = picture_.rgba[i + 2];
        if (2 * r > 3 * std::max(g, b)) return 'r';
        if (2 * g > 3 * std::max(r, b)) return 'g';
        if (2 * b > 3 * std::max(r, g)) return 'b';
        return '.';
    }
    void draw() {
        renderer_->draw(camera_);
        renderer_->read_pixels(picture_);
    }

    const ViewCamera camera_{.position_m = {0, -3, 1}, .target_m = {0, 0, 1}, .fov_deg = 45.0};
    std::optional<gl::OffscreenContext> context_;
    std::optional<SceneRenderer> renderer_;
    RenderedPicture picture_;
};

TEST_F(TexturedTest, BoxShowsItsColourThroughTransparentTexels) {
    const ObjectLook look{.size_m = {1, 1, 1},
                          .colour = {0.7, 0.7, 0.7},
                          .texture = "quarters",
                          .world_from_object = {Eigen::Quaterniond::Identity(), {0, 0, 1}}};
    renderer_->set_object(1, look);
    draw();
    EXPECT_EQ(hue_at({-0.25, -0.5, 1.25}), '.')
        << "the box must be plain until its picture is loaded";
    renderer_->set_texture("quarters", quarters());
    draw();
    EXPECT_EQ(hue_at({-0.25, -0.5, 1.25}), 'r');
    EXPECT_EQ(hue_at({0.25, -0.5, 1.25}), 'g');
    EXPECT_EQ(hue_at({-0.25, -0.5, 0.75}), 'b');
    EXPECT_EQ(hue_at({0.25, -0.5, 0.75}), '.');
}

TEST_F(TexturedTest, ModelShowsTheColoursOfItsVerticesUnlessItHasAPicture) {
    auto wall = std::make_shared<ShapeMesh>();
    const Eigen::Vector3f towards(0, -1, 0);
    for (const Eigen::Vector3f& p : {Eigen::Vector3f(-1, 0, 0.5F),
                                     Eigen::Vector3f(1, 0, 0.5F),
                                     Eigen::Vector3f(1, 0, 1.5F),
                                     Eigen::Vector3f(-1, 0, 1.5F)}) {
        wall->corners.push_back({p, towards, {0.25F, 0.75F}});
        wall->colours.emplace_back(p.x() < 0 ? 0.8F : 0.0F, p.x() < 0 ? 0.0F : 0.8F, 0.0F);
    }
    wall->indices = {0, 1, 2, 0, 2, 3};
    ObjectLook look{.model = wall, .colour = {0.1, 0.1, 0.8}};
    renderer_->set_object(1, look);
    draw();
    EXPECT_EQ(hue_at({-0.6, 0, 1}), 'r');
    EXPECT_EQ(hue_at({0.6, 0, 1}), 'g');
    EXPECT_EQ(hue_at({0, 0, 1}), '.') << "they blend";
    look.texture = "quarters";
    renderer_->set_texture("quarters", quarters());
    renderer_->set_object(1, look);
    draw();
    EXPECT_EQ(hue_at({-0.6, 0, 1}), 'b');
}

TEST_F(TexturedTest, PictureTurnsWithItsBall) {
    renderer_->set_texture("quarters", quarters());
    ObjectLook look{.shape = ShapeKind::kSphere,
                    .size_m = {1, 1, 1},
                    .colour = {0.7, 0.7, 0.7},
                    .texture = "quarters",
                    .world_from_object = {Eigen::Quaterniond::Identity(), {0, 0, 1}}};
    renderer_->set_object(1, look);
    draw();
    // from -y, the second half of the wrap is visible
    EXPECT_EQ(hue_at({0, -0.45, 1.2}), 'g');
    EXPECT_EQ(hue_at({0, -0.45, 0.8}), '.');
    look.world_from_object.rotation = Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ());
    renderer_->move_object(1, look.world_from_object);
    draw();
    EXPECT_EQ(hue_at({0, -0.45, 1.2}), 'r');
    EXPECT_EQ(hue_at({0, -0.45, 0.8}), 'b');
}

TEST_F(TexturedTest, FloorSceneryAndClothShowPictures) {
    renderer_->set_texture("quarters", quarters());
    renderer_->set_object(1,
                          {.shape = ShapeKind::kPlane,
                           .size_m = {8, 8, 0},
                           .colour = {0.5, 0.5, 0.5},
                           .texture = "quarters"});
    renderer_->set_scenery(
        "wall",
        std::vector{
            ObjectLook{.size_m = {0.4, 0.4, 0.4},
                       .texture = "quarters",
                       .world_from_object = {Eigen::Quaterniond::Identity(), {-0.6, 0, 1}}}});
    renderer_->set_soft_object(
        2, {.num_nodes = 4, .triangles = {{0, 3, 1}, {0, 2, 3}}, .texture = "quarters"});
    const std::vector<Eigen::Vector3f> nodes{
        {0.4F, 0, 1.2F}, {0.8F, 0, 1.2F}, {0.4F, 0, 0.8F}, {0.8F, 0, 0.8F}};
    renderer_->move_soft_object(2, nodes);
    draw();
    EXPECT_EQ(hue_at({0.25, -0.25, 0}), 'r') << "the picture must repeat per metre from the origin";
    EXPECT_EQ(hue_at({-0.25, -0.25, 0}), 'g');
    EXPECT_EQ(hue_at({0.25, 0.25, 0}), 'b');
    EXPECT_EQ(hue_at({-0.7, -0.2, 1.1}), 'r');
    EXPECT_EQ(hue_at({-0.5, -0.2, 1.1}), 'g');
    EXPECT_EQ(hue_at({0.5, 0, 1.1}), 'r');
    EXPECT_EQ(hue_at({0.7, 0, 1.1}), 'g');
    EXPECT_EQ(hue_at({0.5, 0, 0.9}), 'b');
}

}  // namespace
}  // namespace atrium::renderer
