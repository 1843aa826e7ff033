#include "tests/unit/renderer/synthetic_person.hpp"
#include "viewer/renderer/person/person_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace atrium::renderer {
namespace {

const synthetic::Sphere kBall{{0.0, 0.0, 1.0}, 0.5};

PersonModel model_of_ball(const CameraPicture& picture) {
    PersonModelScratch scratch;
    PersonModel model;
    build_person_model(synthetic::mesh_of({kBall}, 24), {&picture, 1}, {}, scratch, model);
    return model;
}

// Largest difference of the fallback colours along the edges that lie in x < `limit_m`.
float largest_step(const PersonModel& model, float limit_m) {
    float largest = 0.0f;
    for (const auto& triangle : model.triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t a = triangle[i];
            const std::uint32_t b = triangle[(i + 1) % 3];
            if (model.vertices_site[a].x() > limit_m || model.vertices_site[b].x() > limit_m)
                continue;
            largest = std::max(largest, (model.fallback[a] - model.fallback[b]).norm());
        }
    }
    return largest;
}

TEST(FallbackColours, RunIntoEachOtherWhereNoCameraSees) {
    const auto camera = synthetic::camera_at({3.0, 0.0, 1.0}, kBall.centre);
    const auto stripes = [](const Eigen::Vector3d& p) {
        return std::sin(40.0 * p.z()) > 0.0 ? Eigen::Vector3d(0.8, 0.1, 0.1)
                                            : Eigen::Vector3d(0.1, 0.1, 0.8);
    };
    const PersonModel model = model_of_ball(synthetic::picture_of({kBall}, camera, stripes));
    EXPECT_GT(largest_step(model, 1.0f), 0.5f) << "the seen side is striped";
    EXPECT_LT(largest_step(model, -0.2f), 0.12f) << "the far side is soft";
    for (const Eigen::Vector3f& colour : model.fallback) {
        EXPECT_GE(colour.minCoeff(), 0.05f);
        EXPECT_LE(colour.maxCoeff(), 0.85f);
    }
}

TEST(FallbackColours, DoNotComeFromTheOutline) {
    const auto camera = synthetic::camera_at({3.0, 0.0, 1.0}, kBall.centre);
    const Eigen::Vector3d grey(0.5, 0.5, 0.5);
    CameraPicture picture =
        synthetic::picture_of({kBall}, camera, [&](const Eigen::Vector3d&) { return grey; });
    const CameraPicture clean = picture;
    const auto is_person = [&](int x, int y) {
        return clean.rgba[4 * static_cast<std::size_t>(y * clean.width + x) + 3] >= 128;
    };
    int num_outline = 0;
    for (int y = 1; y + 1 < clean.height; ++y) {
        for (int x = 1; x + 1 < clean.width; ++x) {
            if (!is_person(x, y) || (is_person(x - 1, y) && is_person(x + 1, y) &&
                                     is_person(x, y - 1) && is_person(x, y + 1)))
                continue;
            std::uint8_t* rgba =
                picture.rgba.data() + 4 * static_cast<std::size_t>(y * clean.width + x);
            rgba[0] = rgba[2] = 0;
            rgba[1] = 255;
            ++num_outline;
        }
    }
    ASSERT_GT(num_outline, 100);
    const PersonModel model = model_of_ball(picture);
    for (std::size_t v = 0; v < model.fallback.size(); ++v) {
        if (model.vertices_site[v].x() > -0.15f) continue;
        EXPECT_LT((model.fallback[v].cast<double>() - grey).norm(), 0.1) << v;
    }
}

}  // namespace
}  // namespace atrium::renderer
