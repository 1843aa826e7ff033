#pragma once

#include "core/gl/offscreen_context.hpp"
#include "tests/unit/renderer/synthetic_person.hpp"
#include "viewer/renderer/scene_renderer.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace atrium::renderer {

inline constexpr int kWidth = 480;
inline constexpr int kHeight = 360;

inline PersonModel person_of(const std::vector<synthetic::Sphere>& spheres,
                             const std::vector<CameraPicture>& pictures) {
    PersonModelScratch scratch;
    PersonModel model;
    build_person_model(synthetic::mesh_of(spheres, 40), pictures, {}, scratch, model);
    return model;
}

/// Ray of pixel (x, y), from the definition of the view, not from its matrices.
inline Eigen::Vector3d ray_of(const ViewCamera& camera, int x, int y) {
    const Eigen::Vector3d forward = (camera.target_m - camera.position_m).normalized();
    const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
    const Eigen::Vector3d up = right.cross(forward);
    const double half = std::tan(camera.fov_deg * std::numbers::pi / 360.0);
    const double u = ((x + 0.5) / kWidth * 2.0 - 1.0) * half * kWidth / kHeight;
    const double v = (1.0 - (y + 0.5) / kHeight * 2.0) * half;
    return (forward + u * right + v * up).normalized();
}

/// A renderer without a window, and its last picture.
class SceneRendererTest : public testing::Test {
protected:
    void SetUp() override {
        auto context = gl::OffscreenContext::create(16, 16);
        ASSERT_TRUE(context) << context.error().message;
        context_.emplace(std::move(*context));
        auto renderer = SceneRenderer::create({.width = kWidth, .height = kHeight});
        ASSERT_TRUE(renderer) << renderer.error().message;
        renderer_.emplace(std::move(*renderer));
    }
    void TearDown() override { renderer_.reset(); }

    void draw(const ViewCamera& camera) {
        renderer_->draw(camera);
        renderer_->read_pixels(picture_);
    }
    Eigen::Vector3d pixel(int x, int y) const {
        const std::size_t i =
            4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture_.width) +
                 static_cast<std::size_t>(x));
        return Eigen::Vector3d(picture_.rgba[i], picture_.rgba[i + 1], picture_.rgba[i + 2]) /
               255.0;
    }
    Eigen::Vector3d pixel_at(const ViewCamera& camera, const Eigen::Vector3d& p_world) const {
        const Eigen::Vector2d px = project_px(camera, p_world, picture_.width, picture_.height);
        return pixel(static_cast<int>(std::lround(px.x())), static_cast<int>(std::lround(px.y())));
    }
    // Number of pixels that are darker in `now` than before, in rows from `top_row` on.
    static int num_darker(const RenderedPicture& now,
                          const RenderedPicture& before,
                          int top_row = 0) {
        int count = 0;
        const auto first = static_cast<std::size_t>(4 * top_row * now.width);
        for (std::size_t i = first; i < now.rgba.size(); i += 4)
            count += now.rgba[i] + 10 < before.rgba[i] ? 1 : 0;
        return count;
    }

    std::optional<gl::OffscreenContext> context_;
    std::optional<SceneRenderer> renderer_;
    RenderedPicture picture_;
};

}  // namespace atrium::renderer
