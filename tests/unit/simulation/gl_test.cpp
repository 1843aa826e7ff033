#include "core/gl/offscreen_context.hpp"
#include "core/gl/resources.hpp"
#include "core/gl/shader_program.hpp"

#include <glad/gl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <thread>
#include <vector>

namespace atrium::gl {
namespace {

constexpr const char* kVertexShader = R"(#version 330 core
layout(location = 0) in vec2 position;
void main() { gl_Position = vec4(position, 0.0, 1.0); }
)";
constexpr const char* kFragmentShader = R"(#version 330 core
uniform vec3 colour;
out vec4 fragment;
void main() { fragment = vec4(colour, 1.0); }
)";

using Pixel = std::array<int, 3>;

// Draws a triangle over the lower left half of a private framebuffer.
struct HalfScreen {
    int width = 16;
    int height = 16;
    Eigen::Vector3f colour = {1.0f, 0.0f, 0.0f};

    Expected<std::vector<std::uint8_t>> draw() const {
        auto program = ShaderProgram::create("half", kVertexShader, kFragmentShader);
        if (!program) return tl::unexpected(program.error());
        auto target = make_framebuffer(width, height);
        if (!target) return tl::unexpected(target.error());
        const VertexArray vertex_array = make_vertex_array();
        glBindVertexArray(vertex_array.id());
        const Buffer corners = make_buffer();
        const std::vector<float> xy = {-1.0f, -1.0f, 1.0f, -1.0f, -1.0f, 1.0f};
        upload(corners, GL_ARRAY_BUFFER, std::span<const float>(xy), GL_STATIC_DRAW);
        float_attribute(0, 2, 2 * sizeof(float), 0);
        target->bind();
        glClearColor(0.0f, 0.0f, 1.0f, 1.0f);
        glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
        program->use();
        program->set("colour", colour);
        glDrawArrays(GL_TRIANGLES, 0, 3);
        std::vector<std::uint8_t> rgba(static_cast<std::size_t>(width * height * 4));
        read_rgba(width, height, rgba);
        return rgba;
    }

    Pixel at(const std::vector<std::uint8_t>& rgba, int x, int y) const {
        const std::size_t i = static_cast<std::size_t>((y * width + x) * 4);
        return {rgba[i], rgba[i + 1], rgba[i + 2]};
    }
};

TEST(OffscreenContext, ReadsAFramebufferBackBottomRowFirst) {
    const auto context = OffscreenContext::create(8, 8);
    ASSERT_TRUE(context) << context.error().message;
    const HalfScreen scene;
    const auto rgba = scene.draw();
    ASSERT_TRUE(rgba) << rgba.error().message;
    EXPECT_EQ(scene.at(*rgba, 1, 1), (Pixel{255, 0, 0}));
    EXPECT_EQ(scene.at(*rgba, 14, 14), (Pixel{0, 0, 255}));
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST(OffscreenContext, DrawsIndependentPicturesOnSeveralThreads) {
    constexpr std::size_t kNumThreads = 4;
    std::array<Pixel, kNumThreads> seen{};
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < kNumThreads; ++i) {
        threads.emplace_back([i, &seen] {
            const auto context = OffscreenContext::create(4, 4);
            if (!context) return;
            const HalfScreen scene{.colour = {static_cast<float>(i) / 4.0f, 1.0f, 0.0f}};
            for (int repeat = 0; repeat < 10; ++repeat) {
                const auto rgba = scene.draw();
                if (rgba) seen[i] = scene.at(*rgba, 1, 1);
            }
        });
    }
    threads.clear();
    for (std::size_t i = 0; i < kNumThreads; ++i) {
        EXPECT_NEAR(seen[i][0], 255.0 * static_cast<double>(i) / 4.0, 1.0) << "thread " << i;
        EXPECT_EQ(seen[i][1], 255) << "thread " << i;
    }
}

TEST(OffscreenContext, CanMoveToAnotherThread) {
    auto context = OffscreenContext::create(4, 4);
    ASSERT_TRUE(context) << context.error().message;
    context->release();
    Pixel seen{};
    std::jthread([&] {
        if (!context->make_current()) return;
        const HalfScreen scene;
        if (const auto rgba = scene.draw()) seen = scene.at(*rgba, 0, 0);
        context->release();
    }).join();
    EXPECT_EQ(seen, (Pixel{255, 0, 0}));
}

TEST(ShaderProgram, NamesAStageThatDoesNotCompile) {
    const auto context = OffscreenContext::create(4, 4);
    ASSERT_TRUE(context) << context.error().message;
    const auto program = ShaderProgram::create(
        "broken_one",
        kVertexShader,
        "#version 330 core\nout vec4 c;\nvoid main() { c = vec4(undeclared_thing); }");
    ASSERT_FALSE(program);
    EXPECT_THAT(program.error().message, testing::HasSubstr("broken_one (fragment)"));
    EXPECT_THAT(program.error().message, testing::HasSubstr("undeclared_thing"));
}

TEST(ShaderProgram, ReportsStagesThatDoNotLink) {
    const auto context = OffscreenContext::create(4, 4);
    ASSERT_TRUE(context) << context.error().message;
    const auto program =
        ShaderProgram::create("unlinked",
                              "#version 330 core\nout vec2 shared_name;\n"
                              "void main() { shared_name = vec2(1.0); gl_Position = vec4(0.0); }",
                              "#version 330 core\nin vec3 shared_name;\nout vec4 c;\nvoid main() { "
                              "c = vec4(shared_name, 1.0); }");
    ASSERT_FALSE(program);
    EXPECT_THAT(program.error().message, testing::HasSubstr("unlinked (link)"));
}

}  // namespace
}  // namespace atrium::gl
