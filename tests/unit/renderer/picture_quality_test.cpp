#include "tests/unit/renderer/scene_renderer_fixture.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>

namespace atrium::renderer {
namespace {

/// A red box that casts a shadow, seen from the side.
class PictureQuality : public SceneRendererTest {
protected:
    void SetUp() override {
        SceneRendererTest::SetUp();
        ObjectLook box{
            .shape = ShapeKind::kBox, .size_m = {0.5, 0.5, 0.5}, .colour = {0.8, 0.02, 0.02}};
        box.world_from_object.translation = {0.0, 0.0, 0.9};
        renderer_->set_object(0, box);
    }
    RenderedPicture drawn() {
        draw(camera_);
        return picture_;
    }
    // mean over all channels, of 255
    static double mean_difference(const RenderedPicture& a, const RenderedPicture& b) {
        double sum = 0.0;
        for (std::size_t i = 0; i < a.rgba.size(); ++i)
            sum += std::abs(int{a.rgba[i]} - int{b.rgba[i]});
        return sum / static_cast<double>(a.rgba.size());
    }

    const ViewCamera camera_{.position_m = {0.7, -3.0, 1.6}, .target_m = {0.0, 0.0, 0.7}};
};

TEST_F(PictureQuality, ScaledPictureShowsTheSameSceneAtTheSameSize) {
    const RenderedPicture full = drawn();
    double before = 0.0;
    for (const double scale : {0.75, 0.5}) {
        ASSERT_TRUE(renderer_->set_scale(scale));
        const RenderedPicture scaled = drawn();
        ASSERT_EQ(scaled.width, kWidth);
        ASSERT_EQ(scaled.height, kHeight);
        EXPECT_EQ(renderer_->width(), kWidth);
        const double difference = mean_difference(full, scaled);
        EXPECT_GT(difference, before) << "a smaller scale must differ more";
        EXPECT_LT(difference, 2.0) << scale;
        before = difference;
        // a shift by one pixel of the picture would show at the box's outline
        for (const Eigen::Vector3d& p : {Eigen::Vector3d(0, 0, 0.9), Eigen::Vector3d(0.2, 0, 1.1)})
            EXPECT_GT(pixel_at(camera_, p).x(), 2.0 * pixel_at(camera_, p).y());
    }
}

TEST_F(PictureQuality, FullScaleReturnsBitForBit) {
    const RenderedPicture full = drawn();
    ASSERT_TRUE(renderer_->set_scale(0.5));
    EXPECT_NE(drawn().rgba, full.rgba);
    ASSERT_TRUE(renderer_->set_scale(1.0));
    EXPECT_EQ(drawn().rgba, full.rgba);
}

TEST_F(PictureQuality, AnyScaleWorksWithAnySize) {
    renderer_->remove_object(0);  // it would fill a picture of one pixel
    for (const double scale : {0.5, 0.33, 0.01}) {
        ASSERT_TRUE(renderer_->set_scale(scale));
        for (const auto& [width, height] : {std::array{201, 99}, std::array{17, 16}}) {
            ASSERT_TRUE(renderer_->resize(width, height));
            draw(camera_);
            EXPECT_EQ(picture_.width, width);
            EXPECT_EQ(picture_.height, height);
            EXPECT_GT(pixel(width / 2, 0).z(), 0.3) << "sky, not black";
            EXPECT_GT(pixel(width - 1, height - 1).z(), 0.3) << "the ground must reach the corner";
        }
    }
}

TEST_F(PictureQuality, LabelsKeepTheFullResolution) {
    TexturePicture stripes{32, 8, {}};  // of 4 pixels each
    for (int i = 0; i < 32 * 8; ++i) {
        const std::uint8_t level = i / 4 % 2 == 0 ? 255 : 0;
        stripes.rgba.insert(stripes.rgba.end(), {level, level, level, 255});
    }
    const double height = 16.0 / kHeight;
    renderer_->overlay().set_labels({{.picture = std::make_shared<const TexturePicture>(stripes),
                                      .at_world = {0, 0, 1.3},
                                      .height = height}});
    const Eigen::Vector2d foot = project_px(camera_, {0, 0, 1.3}, kWidth, kHeight);
    const RenderedPicture full = drawn();
    ASSERT_TRUE(renderer_->set_scale(0.25));
    const RenderedPicture scaled = drawn();
    int num_same = 0;
    for (int y = static_cast<int>(foot.y()) - 14; y < static_cast<int>(foot.y()) - 2; ++y) {
        for (int x = static_cast<int>(foot.x()) - 28; x < static_cast<int>(foot.x()) + 28; ++x) {
            const std::size_t i = 4 * static_cast<std::size_t>(y * kWidth + x);
            num_same += full.rgba[i] == scaled.rgba[i] ? 1 : 0;
        }
    }
    EXPECT_EQ(num_same, 12 * 56);
}

TEST_F(PictureQuality, EyesKeepTheirPartsAndColours) {
    ViewCamera other = camera_;
    other.position_m.x() -= 1.0;
    ASSERT_TRUE(renderer_->set_scale(0.5));
    const auto seen_by = [&](const std::vector<EyeView>& eyes) {
        renderer_->draw(eyes);
        renderer_->read_pixels(picture_);
        return picture_;
    };
    EyeView left = eye_of(camera_, kWidth, kHeight);
    EyeView right = eye_of(other, kWidth, kHeight);
    const RenderedPicture left_alone = seen_by({left});
    const RenderedPicture right_alone = seen_by({right});
    left.writes = {true, false, false};
    right.writes = {false, true, true};
    const RenderedPicture both = seen_by({left, right});
    for (std::size_t i = 0; i < both.rgba.size(); i += 4) {
        ASSERT_EQ(both.rgba[i], left_alone.rgba[i]);
        ASSERT_EQ(both.rgba[i + 1], right_alone.rgba[i + 1]);
        ASSERT_EQ(both.rgba[i + 2], right_alone.rgba[i + 2]);
    }
    // side by side: except at the seam, the left half does not depend on the right half
    left.writes = right.writes = {true, true, true};
    left.part_px = {0, 0, kWidth / 2, kHeight};
    right.part_px = {kWidth / 2, 0, kWidth / 2, kHeight};
    const RenderedPicture halves = seen_by({left, right});
    right.view_from_world = left.view_from_world;
    const RenderedPicture same = seen_by({left, right});
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth / 2 - 2; ++x) {
            const std::size_t i = 4 * static_cast<std::size_t>(y * kWidth + x);
            ASSERT_EQ(halves.rgba[i], same.rgba[i]) << x << ", " << y;
        }
    }
    EXPECT_NE(halves.rgba, same.rgba);
}

TEST_F(PictureQuality, FloorIsLitWithoutShadows) {
    const RenderedPicture shaded = drawn();
    EXPECT_TRUE(renderer_->has_shadows());
    renderer_->set_shadows(false);
    const RenderedPicture lit = drawn();
    EXPECT_GT(num_darker(shaded, lit), 100);
    EXPECT_EQ(num_darker(lit, shaded), 0);
    // an object that moved meanwhile has its shadow at its new place when shadows return
    renderer_->move_object(0, {Eigen::Quaterniond::Identity(), {0.3, 0.0, 0.9}});
    const RenderedPicture moved_lit = drawn();
    renderer_->set_shadows(true);
    const RenderedPicture moved = drawn();
    EXPECT_GT(num_darker(moved, moved_lit), 100);
    renderer_->move_object(0, {Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.9}});
    EXPECT_EQ(drawn().rgba, shaded.rgba);
}

// The first picture of a view draws floor and sky, and the second copies them.
TEST_F(PictureQuality, CopiedBackgroundEqualsADrawnOne) {
    ViewCamera camera{.position_m = {2.5, -2.5, 1.6}, .target_m = {0.0, 0.0, 0.4}};
    ViewCamera elsewhere = camera;
    elsewhere.fov_deg = 50.0;
    ObjectLook floor{.shape = ShapeKind::kPlane, .size_m = {3.0, 3.0, 0.0}};
    renderer_->set_object(7, floor);
    const auto compare = [&](const char* when) {
        draw(camera);  // another floor than the kept one
        const RenderedPicture copied = picture_;
        draw(elsewhere);
        draw(camera);
        EXPECT_EQ(picture_.rgba, copied.rgba) << when;
    };
    draw(camera);
    compare("as it was");
    draw(camera);
    floor.colour = {0.1, 0.3, 0.2};
    renderer_->set_object(7, floor);
    compare("another colour");
    draw(camera);
    renderer_->move_object(
        7, {Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ())), {0.5, 0.1, 0.0}});
    compare("another place");
    draw(camera);
    ASSERT_TRUE(renderer_->set_scale(0.5));
    compare("another scale");
    ASSERT_TRUE(renderer_->set_scale(1.0));
    draw(camera);
    renderer_->remove_object(7);
    compare("gone");
}

TEST_F(PictureQuality, WarmUpLeavesNoTraces) {
    const RenderedPicture before = drawn();
    renderer_->remove_object(0);
    renderer_->warm_up(camera_);
    EXPECT_EQ(renderer_->num_objects(), 0U);
    EXPECT_EQ(renderer_->num_people(), 0U);
    EXPECT_EQ(renderer_->scale(), 1.0);
    renderer_->set_object(0,
                          {.size_m = {0.5, 0.5, 0.5},
                           .colour = {0.8, 0.02, 0.02},
                           .world_from_object = {Eigen::Quaterniond::Identity(), {0, 0, 0.9}}});
    EXPECT_EQ(drawn().rgba, before.rgba);
}

// The renderer multiplies shadows onto the floor cell by cell, just above it. From no view may a
// cell be missing or twice as dark.
TEST_F(PictureQuality, ShadowHasNoHolesOrSeams) {
    renderer_->set_object(0, {.shape = ShapeKind::kPlane, .size_m = {3.0, 3.0, 0.0}});
    renderer_->set_object(1,
                          {.size_m = {2.4, 2.4, 0.02},
                           .world_from_object = {Eigen::Quaterniond::Identity(), {0, 0, 3.0}}});
    // a square metre of the floor that lies completely in the shadow
    const Eigen::Vector3d light(0.30, -0.22, 1.0);
    const Eigen::Vector2d middle = -3.0 * light.head<2>();
    for (const double distance_m : {1.5, 3.0, 8.0, 18.0}) {
        for (const double height_m : {0.2, 0.9, 2.4}) {
            const Eigen::Vector3d target(middle.x(), middle.y(), 0.0);
            const ViewCamera camera{
                .position_m = target + Eigen::Vector3d(0.6, -0.8, 0.0) * distance_m +
                              Eigen::Vector3d(0.0, 0.0, height_m),
                .target_m = target,
                .fov_deg = 2.0 * 180.0 / std::numbers::pi * std::atan(0.9 / distance_m)};
            renderer_->set_shadows(false);
            draw(camera);
            const RenderedPicture lit = picture_;
            renderer_->set_shadows(true);
            draw(camera);
            int num = 0;
            for (int y = 0; y < kHeight; ++y) {
                for (int x = 0; x < kWidth; ++x) {
                    const Eigen::Vector3d ray = ray_of(camera, x, y);
                    const Eigen::Vector3d p =
                        camera.position_m - ray * (camera.position_m.z() / ray.z());
                    if (ray.z() >= 0.0 || (p.head<2>() - middle).cwiseAbs().maxCoeff() > 0.5)
                        continue;
                    const std::size_t i = 4 * static_cast<std::size_t>(y * kWidth + x);
                    ASSERT_NEAR(picture_.rgba[i], 0.7 * lit.rgba[i], 1.5)
                        << distance_m << " m away, " << height_m << " m high, at " << x << ", "
                        << y;
                    ++num;
                }
            }
            EXPECT_GT(num, 400) << distance_m << " m away, " << height_m << " m high";
        }
    }
}

}  // namespace
}  // namespace atrium::renderer
