#include "core/gl/offscreen_context.hpp"
#include "viewer/renderer/scene_renderer.hpp"
#include "viewer/ui/display.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

// Compares the places of a ball in the pictures of two eyes with geometry.
namespace atrium::viewer {
namespace {

using renderer::EyeView;
using renderer::SceneRenderer;
using renderer::ViewCamera;

constexpr double kEyeDistance_m = 0.064;
constexpr double kConvergence_m = 2.5;
// The centroid of 400 to 800 pixels, with an outline rounded to pixels, is accurate to 0.1 px. The
// test subtracts two of them.
constexpr double kTolerance_px = 0.3;
// For one eye alone. Off the axis, the middle of a ball's outline differs from the image of its
// middle by (radius / distance)^2 of the distance to the axis: 0.2 px.
constexpr double kOffAxis_px = 0.2;
constexpr double kRadiusOverDepth = 0.02;

struct Mode {
    std::string stereo;
    std::array<int, 2> surface_px;
};

class StereoPair : public testing::TestWithParam<Mode> {
protected:
    void SetUp() override {
        auto context = gl::OffscreenContext::create(16, 16);
        ASSERT_TRUE(context) << context.error().message;
        context_.emplace(std::move(*context));
        auto display = Display::create({.stereo = GetParam().stereo,
                                        .eye_distance_m = kEyeDistance_m,
                                        .convergence_m = kConvergence_m});
        ASSERT_TRUE(display) << display.error().message;
        const auto [width, height] = display->picture_size(GetParam().surface_px);
        eyes_ = display->eyes(camera_, width, height);
        ASSERT_EQ(eyes_.size(), 2U);
        auto renderer = SceneRenderer::create({.width = width, .height = height});
        ASSERT_TRUE(renderer) << renderer.error().message;
        renderer_.emplace(std::move(*renderer));
    }
    void TearDown() override { renderer_.reset(); }

    // A ball at x to the right, y up and z in front of the middle between the eyes.
    void put_ball(const Eigen::Vector3d& at_m) {
        const Eigen::Vector3d forward = (camera_.target_m - camera_.position_m).normalized();
        const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
        const Eigen::Vector3d up = right.cross(forward);
        renderer_->set_object(
            1,
            {.shape = renderer::ShapeKind::kSphere,
             .size_m = Eigen::Vector3d::Constant(2.0 * kRadiusOverDepth * at_m.z()),
             .colour = {0.9, 0.0, 0.0},
             .world_from_object = {
                 Eigen::Quaterniond::Identity(),
                 camera_.position_m + at_m.x() * right + at_m.y() * up + at_m.z() * forward}});
        renderer_->draw(eyes_);
        renderer_->read_pixels(picture_);
    }
    // The middle of the red pixels in the eye's part, from the part's upper left corner [px].
    Eigen::Vector2d seen_at(std::size_t eye) const {
        const image::PixelRect& part = eyes_[eye].part_px;
        Eigen::Vector2d sum = Eigen::Vector2d::Zero();
        double num = 0.0;
        for (int y = 0; y < part.height; ++y) {
            for (int x = 0; x < part.width; ++x) {
                const auto at = 4 * (static_cast<std::size_t>(part.y + y) *
                                         static_cast<std::size_t>(picture_.width) +
                                     static_cast<std::size_t>(part.x + x));
                // the shadow, the floor and the sky are grey
                if (10 * picture_.rgba[at] < 12 * picture_.rgba[at + 1]) continue;
                sum += Eigen::Vector2d(x, y);
                num += 1.0;
            }
        }
        EXPECT_GT(num, 100.0);
        return sum / num;
    }
    // Pixels per unit of the tangent, in a part that may be squeezed.
    Eigen::Vector2d focal_px() const {
        const auto [width, height] = GetParam().surface_px;
        const double half_height = std::tan(0.5 * camera_.fov_deg * std::numbers::pi / 180.0);
        const double half_width = half_height * width / height;
        return {0.5 * eyes_[0].part_px.width / half_width,
                0.5 * eyes_[0].part_px.height / half_height};
    }

    const ViewCamera camera_{
        .position_m = {0.4, -4.0, 1.6}, .target_m = {0.0, 0.0, 1.3}, .fov_deg = 38.0};
    std::optional<gl::OffscreenContext> context_;
    std::vector<EyeView> eyes_;
    std::optional<SceneRenderer> renderer_;
    renderer::RenderedPicture picture_;
};

TEST_P(StereoPair, HasTheRightHorizontalAndNoVerticalDisparity) {
    const Eigen::Vector2d focal = focal_px();
    for (const Eigen::Vector3d& at : {Eigen::Vector3d(0.0, 0.0, kConvergence_m),
                                      {0.0, 0.0, 1.2},
                                      {0.0, 0.0, 6.0},
                                      {0.7, 0.4, kConvergence_m},
                                      {-0.35, 0.25, 1.2},
                                      {0.3, -0.3, 1.5},
                                      {-1.6, 0.8, 4.0}}) {
        SCOPED_TRACE(at.transpose());
        put_ball(at);
        const std::array<Eigen::Vector2d, 2> seen{seen_at(0), seen_at(1)};
        // The screen stands across the view at the convergence distance. An eye `offset` to the
        // right of the middle sees (x, z) on it at offset + (x - offset) * convergence / z.
        const double disparity_px =
            focal.x() * kEyeDistance_m * (1.0 / at.z() - 1.0 / kConvergence_m);
        EXPECT_NEAR(seen[0].x() - seen[1].x(), disparity_px, kTolerance_px);
        EXPECT_NEAR(seen[0].y(), seen[1].y(), kTolerance_px);
        for (const std::size_t eye : {0U, 1U}) {
            const double own_px = (eye == 0 ? 0.5 : -0.5) * disparity_px;
            const image::PixelRect& part = eyes_[eye].part_px;
            const double x_px = 0.5 * (part.width - 1) + focal.x() * at.x() / at.z() + own_px;
            const double y_px = 0.5 * (part.height - 1) - focal.y() * at.y() / at.z();
            EXPECT_NEAR(seen[eye].x(), x_px, kTolerance_px + kOffAxis_px) << eye;
            EXPECT_NEAR(seen[eye].y(), y_px, kTolerance_px + kOffAxis_px) << eye;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Modes,
                         StereoPair,
                         testing::Values(Mode{"side_by_side", {1920, 1080}},
                                         Mode{"top_bottom", {1920, 1080}},
                                         Mode{"quad_buffer", {1920, 1080}}),
                         [](const auto& mode) { return mode.param.stereo; });

}  // namespace
}  // namespace atrium::viewer
