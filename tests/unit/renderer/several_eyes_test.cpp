#include "tests/unit/renderer/scene_renderer_fixture.hpp"
#include "viewer/renderer/screen.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>

namespace atrium::renderer {
namespace {

using synthetic::Sphere;

// Several eyes look at a room with a person, a box and the sky above.
class SeveralEyes : public SceneRendererTest {
protected:
    void SetUp() override {
        SceneRendererTest::SetUp();
        const std::vector<Sphere> body{{{0.0, 0.0, 1.0}, 0.4}};
        std::vector<CameraPicture> pictures;
        for (const auto& camera : synthetic::ring(6, {0.0, 0.0, 1.0})) {
            pictures.push_back(synthetic::picture_of(body, camera, [](const Eigen::Vector3d& p) {
                return Eigen::Vector3d(0.9, 0.3 + 0.2 * std::sin(8.0 * p.z()), 0.2);
            }));
        }
        renderer_->set_person("a", person_of(body, pictures));
        ObjectLook box{.shape = ShapeKind::kBox, .colour = {0.1, 0.4, 0.8}};
        box.size_m = {0.5, 0.5, 0.5};
        box.world_from_object.translation = {0.8, 0.5, 0.25};
        renderer_->set_object(1, box);
        ObjectLook floor{.shape = ShapeKind::kPlane};
        floor.size_m = {6.0, 6.0, 0.0};
        renderer_->set_object(2, floor);
    }
    RenderedPicture seen_by(const std::vector<EyeView>& eyes) {
        renderer_->draw(eyes);
        RenderedPicture picture;
        renderer_->read_pixels(picture);
        return picture;
    }

    const ViewCamera camera_{.position_m = {0.5, -3.5, 1.6}, .target_m = {0.2, 0.0, 0.9}};
};

TEST_F(SeveralEyes, SeeThroughAFadingPerson) {
    const std::vector<EyeView> eye{eye_of(camera_, kWidth, kHeight)};
    const RenderedPicture solid = seen_by(eye);
    renderer_->set_person_opacity("a", 0.25);
    const RenderedPicture faded = seen_by(eye);
    renderer_->set_person_opacity("a", 0.0);
    const RenderedPicture none = seen_by(eye);
    renderer_->set_person_opacity("a", 1.0);
    EXPECT_EQ(seen_by(eye).rgba, solid.rgba);
    std::size_t num_of_person = 0;
    for (std::size_t i = 0; i < solid.rgba.size(); ++i) {
        // The background of the fading person shows through evenly. The shadow fades linearly as
        // well.
        const double expected = 0.25 * solid.rgba[i] + 0.75 * none.rgba[i];
        ASSERT_NEAR(faded.rgba[i], expected, 2.0);
        num_of_person += std::abs(int{solid.rgba[i]} - int{none.rgba[i]}) > 40 ? 1 : 0;
    }
    EXPECT_GT(num_of_person, 3000U);
    renderer_->remove_person("a");
    EXPECT_EQ(seen_by(eye).rgba, none.rgba) << "a fully faded person must have no shadow";
}

TEST_F(SeveralEyes, TilesOfAWallMakeOnePicture) {
    const RenderedPicture whole = seen_by({eye_of(camera_, kWidth, kHeight)});
    const Screen screen = screen_of(camera_, static_cast<double>(kWidth) / kHeight, 2.0);
    const Eigen::Vector3d half = 0.5 * (screen.lower_right_m - screen.lower_left_m);
    std::vector<EyeView> tiles;
    for (const int side : {0, 1}) {
        const Eigen::Vector3d shift = side * half;
        const Screen tile{screen.lower_left_m + shift,
                          screen.lower_left_m + half + shift,
                          screen.upper_left_m + shift};
        tiles.push_back(eye_through(tile,
                                    camera_.position_m,
                                    camera_.near_m,
                                    camera_.far_m,
                                    {side * kWidth / 2, 0, kWidth / 2, kHeight}));
    }
    const RenderedPicture tiled = seen_by(tiles);
    std::size_t num_different = 0;
    for (std::size_t i = 0; i < whole.rgba.size(); ++i)
        num_different += std::abs(int{whole.rgba[i]} - int{tiled.rgba[i]}) > 2 ? 1 : 0;
    // equal except for edges that rounding moves by a pixel
    EXPECT_LT(num_different, whole.rgba.size() / 500);
}

TEST_F(SeveralEyes, HaveTheirOwnColoursInAnAnaglyph) {
    ViewCamera right_camera = camera_;
    right_camera.position_m.x() += 0.3;
    EyeView left = eye_of(camera_, kWidth, kHeight);
    EyeView right = eye_of(right_camera, kWidth, kHeight);
    const RenderedPicture left_alone = seen_by({left});
    const RenderedPicture right_alone = seen_by({right});
    left.writes = {true, false, false};
    right.writes = {false, true, true};
    const RenderedPicture both = seen_by({left, right});
    std::size_t num_apart = 0;
    for (std::size_t i = 0; i < both.rgba.size(); i += 4) {
        ASSERT_EQ(both.rgba[i], left_alone.rgba[i]);
        ASSERT_EQ(both.rgba[i + 1], right_alone.rgba[i + 1]);
        ASSERT_EQ(both.rgba[i + 2], right_alone.rgba[i + 2]);
        num_apart += left_alone.rgba[i] != right_alone.rgba[i] ? 1 : 0;
    }
    EXPECT_GT(num_apart, both.rgba.size() / 40) << "the eyes must see different pictures";
    const RenderedPicture after = seen_by({eye_of(camera_, kWidth, kHeight)});
    EXPECT_EQ(after.rgba, left_alone.rgba) << "the colour mask must be reset";
}

}  // namespace
}  // namespace atrium::renderer
