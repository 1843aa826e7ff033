#include "core/gl/offscreen_context.hpp"
#include "core/gl/resources.hpp"
#include "core/gl/shader_program.hpp"
#include "tests/unit/export/ball_person.hpp"
#include "tools/export/atlas/bake.hpp"
#include "tools/export/atlas/surface_colours.hpp"
#include "viewer/renderer/person/camera_blend.hpp"
#include "viewer/renderer/person/person_drawing.hpp"

#include <glad/gl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace atrium::exporting {
namespace {

constexpr int kSide = 64;

// Draws one triangle of the model by the viewer's shader over a square, with corners at (0, 0),
// (1, 0) and (0, 1).
class ShaderPicture {
public:
    static Expected<renderer::PersonShaders> shaders() { return renderer::PersonShaders::create(); }

    explicit ShaderPicture(const renderer::PersonModel& model) : model_(model) {
        renderer::BlendScratch scratch;
        renderer::blend_for_texture(model, scratch, blended_);
        person_.set_model(model);
    }

    std::vector<std::uint8_t> draw(std::size_t group,
                                   std::size_t index,
                                   const renderer::PersonShaders& shaders) {
        const std::size_t num_cameras = renderer::kCamerasPerTriangle[group];
        const std::size_t floats = renderer::floats_per_vertex(num_cameras);
        std::vector<float> all(blended_.groups[group].num_vertices() * floats);
        renderer::lay_out(model_, blended_, group, all);
        std::vector<float> corners(
            all.begin() + static_cast<std::ptrdiff_t>(3 * index * floats),
            all.begin() + static_cast<std::ptrdiff_t>(3 * (index + 1) * floats));
        for (std::size_t i = 0; i < 3; ++i) {
            corners[i * floats] = i == 1 ? 1.0f : 0.0f;
            corners[i * floats + 1] = i == 2 ? 1.0f : 0.0f;
            corners[i * floats + 2] = 0.0f;
        }
        const auto layout = gl::make_vertex_array();
        const auto buffer = gl::make_buffer();
        glBindVertexArray(layout.id());
        glBindBuffer(GL_ARRAY_BUFFER, buffer.id());
        glBufferData(GL_ARRAY_BUFFER,
                     static_cast<GLsizeiptr>(corners.size() * sizeof(float)),
                     corners.data(),
                     GL_STATIC_DRAW);
        const std::size_t stride = floats * sizeof(float);
        gl::float_attribute(0, 3, stride, 0);
        gl::float_attribute(1, 3, stride, 3 * sizeof(float));
        unsigned attribute = 2;
        std::size_t offset = 6 * sizeof(float);
        for (std::size_t i = 0; i < num_cameras; i += 4) {
            const std::size_t layers = std::min<std::size_t>(num_cameras - i, 4);
            gl::float_attribute(attribute++, static_cast<int>(layers), stride, offset);
            offset += layers * sizeof(float);
        }
        for (std::size_t i = 0; i < num_cameras; ++i, offset += 4 * sizeof(float))
            gl::float_attribute(attribute++, 4, stride, offset);
        Eigen::Matrix4f clip_from_square = Eigen::Matrix4f::Identity();
        clip_from_square.topLeftCorner<2, 2>() *= 2.0f;
        clip_from_square.topRightCorner<2, 1>().setConstant(-1.0f);
        glViewport(0, 0, kSide, kSide);
        glDisable(GL_DEPTH_TEST);
        glDisable(GL_CULL_FACE);
        glClearColor(0, 0, 0, 0);
        glClear(GL_COLOR_BUFFER_BIT);
        glActiveTexture(GL_TEXTURE0);
        glBindTexture(GL_TEXTURE_2D_ARRAY, person_.pictures().id());
        shaders.by_group[group].use();
        shaders.by_group[group].set("clip_from_site", clip_from_square);
        shaders.by_group[group].set("pictures", 0);
        glDrawArrays(GL_TRIANGLES, 0, 3);
        std::vector<std::uint8_t> rgba(4 * kSide * kSide);
        glReadPixels(0, 0, kSide, kSide, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
        return rgba;
    }
    const renderer::BlendedMesh& blended() const { return blended_; }

private:
    const renderer::PersonModel& model_;
    renderer::BlendedMesh blended_;
    renderer::PersonDrawing person_;
};

TEST(SurfaceColours, AreThoseOfTheViewersShader) {
    auto context = gl::OffscreenContext::create(kSide, kSide);
    ASSERT_TRUE(context) << context.error().message;
    const renderer::PersonModel model = testing::ball_model(10);
    const auto shaders = ShaderPicture::shaders();
    ASSERT_TRUE(shaders) << shaders.error().message;
    ShaderPicture picture(model);
    const SurfaceColours surface(model);
    int num_compared = 0;
    int num_off = 0;
    double sum = 0.0;
    for (std::size_t group = 0; group < renderer::kCamerasPerTriangle.size(); ++group) {
        const auto& triangles = picture.blended().groups[group].triangles;
        for (std::size_t index = 0; index < triangles.size(); index += 1 + triangles.size() / 12) {
            const std::vector<std::uint8_t> drawn = picture.draw(group, index, *shaders);
            const TriangleColours colours = surface.of(triangles[index]);
            for (int y = 0; y < kSide; y += 5) {
                for (int x = 0; x + y < kSide - 1; x += 5) {
                    const float b = (static_cast<float>(x) + 0.5f) / kSide;
                    const float c = (static_cast<float>(y) + 0.5f) / kSide;
                    const Eigen::Vector3f own = 255.0f * colours.at({1 - b - c, b, c});
                    for (int i = 0; i < 3; ++i) {
                        const std::size_t at = static_cast<std::size_t>(4 * (y * kSide + x) + i);
                        const double off = std::abs(own[i] - drawn[at]);
                        sum += off;
                        num_off += off > 2.0;
                        EXPECT_LT(off, 20.0)
                            << "group " << group << " triangle " << triangles[index];
                    }
                    ++num_compared;
                }
            }
        }
    }
    ASSERT_GT(num_compared, 2000);
    // Mesa filters in 8 bits: at outlines, whose texels have a small alpha, it rounds most
    EXPECT_LT(sum / (3 * num_compared), 0.6);
    EXPECT_LT(num_off, 3 * num_compared / 20);
}

TEST(BlendForTexture, TakesTheCameraInFrontOfEachPoint) {
    const renderer::PersonModel model = testing::ball_model();
    renderer::BlendScratch scratch;
    renderer::BlendedMesh blended;
    renderer::blend_for_texture(model, scratch, blended);
    std::size_t num_triangles = 0;
    for (const auto& group : blended.groups) num_triangles += group.triangles.size();
    EXPECT_EQ(num_triangles, model.triangles.size()) << "also those that face no camera";
    int count = 0;
    for (std::size_t v = 0; v < model.vertices_site.size(); ++v) {
        const Eigen::Vector3f& p = model.vertices_site[v];
        if (std::abs(p.z() - 1.0f) > 0.2f || p.x() > 0.3f) continue;
        const auto angle = [&](const renderer::PersonModel::Camera& camera) {
            return (camera.centre_site - p).normalized().dot(model.normals[v]);
        };
        const auto best = std::ranges::max_element(model.cameras, {}, angle);
        const auto first = scratch.vertices[v].cameras[0];
        ++count;
        EXPECT_GT(angle(model.cameras[first]), angle(*best) - 0.1f);
        EXPECT_GT(scratch.vertices[v].weights[0], 0.3f);
    }
    EXPECT_GT(count, 100);
}

TEST(SurfaceColours, AreForAnEyeWhereItSeesTheSurface) {
    const renderer::PersonModel model = testing::ball_model();
    const Eigen::Vector3f eye(-4.0f, 1.5f, 1.6f);
    const SurfaceColours of_normals(model);
    const SurfaceColours of_eye(model, eye);
    renderer::BlendScratch scratch;
    renderer::BlendedMesh seen;
    renderer::blend_for_view(model, eye, scratch, seen);
    std::vector<std::uint8_t> is_seen(model.triangles.size(), 0);
    for (const auto& group : seen.groups) {
        for (const std::uint32_t t : group.triangles) is_seen[t] = 1;
    }
    std::size_t num_other = 0;
    const Eigen::Vector3f centre = Eigen::Vector3f::Constant(1.0f / 3.0f);
    for (std::uint32_t t = 0; t < model.triangles.size(); ++t) {
        const bool is_same = of_normals.of(t).at(centre) == of_eye.of(t).at(centre);
        num_other += !is_same;
        EXPECT_TRUE(is_same || is_seen[t] != 0) << t;
    }
    EXPECT_GT(num_other, model.triangles.size() / 10);
}

}  // namespace
}  // namespace atrium::exporting
