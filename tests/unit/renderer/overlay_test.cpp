#include "tests/unit/renderer/scene_renderer_fixture.hpp"

#include <glad/gl.h>
#include <gtest/gtest.h>

#include <array>

namespace atrium::renderer {
namespace {

std::shared_ptr<const TexturePicture> green(int width, int height) {
    TexturePicture picture{width, height, {}};
    for (int i = 0; i < width * height; ++i)
        picture.rgba.insert(picture.rgba.end(), {0, 255, 0, 255});
    return std::make_shared<const TexturePicture>(std::move(picture));
}

class OverlayTest : public SceneRendererTest {
protected:
    struct Box {
        int num = 0;
        std::array<int, 2> low{kWidth, kHeight};
        std::array<int, 2> high{-1, -1};
    };
    // Bounds of the pixels that are greener than anything in the scene.
    Box green_part() const {
        Box box;
        for (int y = 0; y < kHeight; ++y) {
            for (int x = 0; x < kWidth; ++x) {
                const Eigen::Vector3d colour = pixel(x, y);
                if (colour.y() < 0.9 || colour.x() > 0.1) continue;
                ++box.num;
                box.low = {std::min(box.low[0], x), std::min(box.low[1], y)};
                box.high = {std::max(box.high[0], x), std::max(box.high[1], y)};
            }
        }
        return box;
    }

    const ViewCamera camera_{.position_m = {0, -3, 1}, .target_m = {0, 0, 1}};
};

TEST_F(OverlayTest, LabelStandsAtItsPlaceWithOneSizeAtAnyDistance) {
    for (const double y_m : {-1.0, 2.0, 20.0}) {
        const Eigen::Vector3d at(0.3, y_m, 1.1);
        renderer_->overlay().set_labels(
            {{.picture = green(40, 10), .at_world = at, .height = 0.1}});
        draw(camera_);
        const Box box = green_part();
        const Eigen::Vector2d foot = project_px(camera_, at, kWidth, kHeight);
        EXPECT_NEAR(0.5 * (box.low[0] + box.high[0]), foot.x(), 1.0) << y_m;
        EXPECT_NEAR(box.high[1] + 0.5, foot.y(), 1.0);
        EXPECT_NEAR(box.high[1] - box.low[1] + 1, 0.1 * kHeight, 1.0);
        EXPECT_NEAR(box.high[0] - box.low[0] + 1, 0.4 * kHeight, 1.0);
    }
}

TEST_F(OverlayTest, IsDrawnOverEverythingButNotBehindTheEye) {
    ObjectLook wall{.shape = ShapeKind::kBox};
    wall.size_m = {4, 0.1, 4};
    wall.world_from_object.translation = {0, -1, 1};
    renderer_->set_object(1, wall);
    renderer_->overlay().set_labels({{.picture = green(8, 8), .at_world = {0, 0, 1}}});
    draw(camera_);
    EXPECT_GT(green_part().num, 50);
    draw({.position_m = {0, -3, 1}, .target_m = {0, -6, 1}});
    EXPECT_EQ(green_part().num, 0);
    renderer_->overlay().set_labels({});
    draw(camera_);
    EXPECT_EQ(green_part().num, 0);
}

TEST_F(OverlayTest, LabelBlendsByItsOpacity) {
    draw(camera_);
    const Eigen::Vector3d bare = pixel_at(camera_, {0, 0, 1.02});
    const auto picture = green(8, 8);
    for (const double opacity : {0.25, 0.75}) {
        renderer_->overlay().set_labels(
            {{.picture = picture, .at_world = {0, 0, 1}, .opacity = opacity}});
        draw(camera_);
        const Eigen::Vector3d expected =
            opacity * Eigen::Vector3d(0, 1, 0) + (1.0 - opacity) * bare;
        EXPECT_LT((pixel_at(camera_, {0, 0, 1.02}) - expected).norm(), 0.02);
    }
}

TEST_F(OverlayTest, LinesReachTheirEndsAndAreFaintBehindObjects) {
    const Eigen::Vector3f colour(0, 1, 0);
    const std::vector<Line> lines{{{{-0.5F, 0, 1}, colour}, {{0.5F, 0, 1}, colour}}};
    renderer_->overlay().set_lines(lines);
    draw(camera_);
    const Box line = green_part();
    const Eigen::Vector2d from = project_px(camera_, {-0.5, 0, 1}, kWidth, kHeight);
    const Eigen::Vector2d to = project_px(camera_, {0.5, 0, 1}, kWidth, kHeight);
    EXPECT_NEAR(line.low[0], from.x(), 1.5);
    EXPECT_NEAR(line.high[0], to.x(), 1.5);
    EXPECT_EQ(line.low[1], line.high[1]) << "one pixel wide";
    ObjectLook wall{.shape = ShapeKind::kBox, .colour = {0.5, 0.5, 0.5}};
    wall.size_m = {4, 0.1, 4};
    wall.world_from_object.translation = {0, -1, 1};
    renderer_->set_object(1, wall);
    draw(camera_);
    EXPECT_EQ(green_part().num, 0);
    const Eigen::Vector3d hidden = pixel(kWidth / 2, line.low[1]);
    renderer_->overlay().set_lines({});
    draw(camera_);
    const Eigen::Vector3d bare = pixel(kWidth / 2, line.low[1]);
    EXPECT_GT(hidden.y() - hidden.x(), 0.2) << "the line must show through the wall";
    EXPECT_LT(bare.y() - bare.x(), 0.05);
}

TEST_F(OverlayTest, LinesAreWiderInAHigherPicture) {
    std::array<float, 2> range{};
    glGetFloatv(GL_ALIASED_LINE_WIDTH_RANGE, range.data());
    ASSERT_GE(range[1], 3.0F) << "Mesa draws wide lines";
    ASSERT_TRUE(renderer_->resize(400, 2160));
    const Eigen::Vector3f colour(0, 1, 0);
    renderer_->overlay().set_lines(
        std::vector<Line>{{{{-0.1F, 0, 1}, colour}, {{0.1F, 0, 1}, colour}}});
    draw(camera_);
    int num_rows = 0;
    for (int y = 0; y < 2160; ++y) {
        const Eigen::Vector3d at = pixel(200, y);
        num_rows += at.y() > 0.9 && at.x() < 0.1 ? 1 : 0;
    }
    EXPECT_EQ(num_rows, 3);
}

TEST_F(OverlayTest, WiresAreTransparent) {
    ObjectLook ball{.shape = ShapeKind::kSphere, .colour = {0.9, 0, 0}};
    ball.world_from_object.translation = {0, 0, 1};
    renderer_->set_object(1, ball);
    const auto num_red = [&] {
        draw(camera_);
        int num = 0;
        for (std::size_t i = 0; i < picture_.rgba.size(); i += 4)
            num += picture_.rgba[i] > picture_.rgba[i + 1] + 60 ? 1 : 0;
        return num;
    };
    const int num_solid = num_red();
    renderer_->overlay().set_wireframe(true);
    const int num_wires = num_red();
    EXPECT_GT(num_wires, num_solid / 50);
    EXPECT_LT(num_wires, num_solid / 2);
    renderer_->overlay().set_wireframe(false);
    EXPECT_EQ(num_red(), num_solid);
}

// Squeezed side by side, as 3D televisions expect the pictures of two eyes.
TEST_F(OverlayTest, AppearsInEachEyesPartAndIsSqueezedWithIt) {
    renderer_->overlay().set_labels(
        {{.picture = green(10, 10), .at_world = {0, 0, 1}, .height = 0.2}});
    std::vector<EyeView> eyes(2, eye_of(camera_, kWidth, kHeight));
    for (const int i : {0, 1})
        eyes[std::size_t(i)].part_px = {i * kWidth / 2, 0, kWidth / 2, kHeight};
    renderer_->draw(eyes);
    renderer_->read_pixels(picture_);
    const Box both = green_part();
    EXPECT_NEAR(both.num, 2 * 0.2 * kHeight * 0.1 * kHeight, 150);
    EXPECT_NEAR(both.low[0] + both.high[0] + 1, kWidth, 2);
    EXPECT_NEAR(both.low[0], kWidth / 4 - 0.05 * kHeight, 1.5);
    for (EyeView& eye : eyes) eye.part_px = {0, 0, kWidth, kHeight};
    eyes[0].writes = {true, false, false};
    eyes[1].writes = {false, true, true};
    renderer_->draw(eyes);
    renderer_->read_pixels(picture_);
    EXPECT_NEAR(green_part().num, 0.2 * kHeight * 0.2 * kHeight, 150) << "an anaglyph";
}

}  // namespace
}  // namespace atrium::renderer
