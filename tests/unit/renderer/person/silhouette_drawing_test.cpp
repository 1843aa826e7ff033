#include "viewer/renderer/person/silhouette_drawing.hpp"

#include "tests/unit/renderer/scene_renderer_fixture.hpp"

#include <gtest/gtest.h>

namespace atrium::renderer {
namespace {

constexpr double kDistanceM = 0.35;
const Eigen::Vector3d kRed(1.0, 0.1, 0.1);

class Silhouettes : public SceneRendererTest {
protected:
    void SetUp() override {
        SceneRendererTest::SetUp();
        camera_ = synthetic::camera_at({3, 0, 1}, {0, 0, 1});
        picture_of_camera_ =
            synthetic::picture_of(spheres_, camera_, [](const Eigen::Vector3d&) { return kRed; });
        renderer_->set_person("alice", person_of(spheres_, {picture_of_camera_}));
    }
    // Pixels of the camera's picture, where the renderer draws it.
    Eigen::Vector3d place_of(const Eigen::Vector2d& px) const {
        return camera_.camera_from_site.inverse() *
               (kDistanceM * camera_.intrinsics.ray_camera(px));
    }
    Eigen::Vector2d middle_of_crop() const {
        const image::PixelRect& crop = picture_of_camera_.crop_px;
        return {crop.x + 0.5 * crop.width, crop.y + 0.5 * crop.height};
    }

    const std::vector<synthetic::Sphere> spheres_{{{0, 0, 1}, 0.5}};
    geometry::CalibratedCamera camera_;
    CameraPicture picture_of_camera_;
    // from beside the camera, past the person
    const ViewCamera eye_{.position_m = {3.0, 0.35, 1.0}, .target_m = {2.65, 0.0, 1.0}};
};

TEST_F(Silhouettes, AreDrawnAtTheirCameraOnRequest) {
    const Eigen::Vector3d middle = place_of(middle_of_crop());
    draw(eye_);
    const Eigen::Vector3d without = pixel_at(eye_, middle);
    EXPECT_GT((without - kRed).norm(), 0.5) << "the background must show here";
    renderer_->overlay().set_silhouettes(kDistanceM);
    draw(eye_);
    EXPECT_LT((pixel_at(eye_, middle) - kRed).norm(), 0.15);
    renderer_->overlay().set_silhouettes(0.0);
    draw(eye_);
    EXPECT_EQ(pixel_at(eye_, middle), without);
}

TEST_F(Silhouettes, AreTransparentBesideThePersonAndHaveAnOutline) {
    const image::PixelRect& crop = picture_of_camera_.crop_px;
    const Eigen::Vector3d corner =
        place_of({crop.x + 0.04 * crop.width, crop.y + 0.04 * crop.height});
    draw(eye_);
    const Eigen::Vector3d without = pixel_at(eye_, corner);
    renderer_->overlay().set_silhouettes(kDistanceM);
    draw(eye_);
    const double change = (pixel_at(eye_, corner) - without).norm();
    EXPECT_LT(change, 0.2);
    EXPECT_GT(change, 0.01) << "a tint must show the extent of the picture";
    // along a line through the middle: outside, outline, inside
    bool has_outline = false;
    for (int x = crop.x; x < crop.x + crop.width; ++x) {
        const Eigen::Vector3d colour =
            pixel_at(eye_, place_of({static_cast<double>(x), middle_of_crop().y()}));
        has_outline |= colour.z() > 0.8 && colour.x() < 0.4;
    }
    EXPECT_TRUE(has_outline);
}

TEST_F(Silhouettes, AreHiddenByObjectsInFront) {
    ObjectLook wall{.shape = ShapeKind::kBox};
    wall.size_m = {0.02, 0.02, 0.6};
    wall.colour = {0.0, 0.6, 0.0};
    const Eigen::Vector3d middle = place_of(middle_of_crop());
    wall.world_from_object.translation = middle + 0.5 * (eye_.position_m - middle);
    renderer_->set_object(1, wall);
    renderer_->overlay().set_silhouettes(kDistanceM);
    draw(eye_);
    const Eigen::Vector3d colour = pixel_at(eye_, middle);
    EXPECT_GT(colour.y(), colour.x()) << "the wall must hide the silhouette";
}

TEST(AppendSilhouette, RemovesLensDistortion) {
    PersonModel::Camera camera;
    const geometry::CalibratedCamera there = synthetic::camera_at({3, 0, 1}, {0, 0, 1});
    camera.intrinsics = there.intrinsics;
    camera.intrinsics.distortion = {-0.2, 0.05, 0.001, -0.001, 0.0};
    camera.camera_from_site = there.camera_from_site;
    camera.crop_px = {40, 30, 500, 400};
    std::vector<SilhouetteCorner> corners;
    append_silhouette(camera, kDistanceM, corners);
    ASSERT_GT(corners.size(), 6U);
    for (const SilhouetteCorner& corner : corners) {
        const Eigen::Vector3d p_camera = there.camera_from_site * corner.p_site.cast<double>();
        EXPECT_NEAR(p_camera.z(), kDistanceM, 1e-5);
        const Eigen::Vector2d px = camera.intrinsics.distort(camera.intrinsics.project(p_camera));
        const Eigen::Vector2d in_crop(39.5 + 500.0 * static_cast<double>(corner.st.x()),
                                      29.5 + 400.0 * static_cast<double>(corner.st.y()));
        EXPECT_LT((px - in_crop).norm(), 0.01);
    }
}

}  // namespace
}  // namespace atrium::renderer
