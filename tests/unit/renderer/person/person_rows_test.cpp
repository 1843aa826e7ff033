#include "viewer/renderer/person/person_rows.hpp"

#include "core/geometry/pinhole_camera.hpp"
#include "core/image/inverse_depth.hpp"
#include "tests/support/skips.hpp"
#include "tests/unit/renderer/synthetic_person.hpp"
#include "viewer/renderer/person/camera_blend.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace atrium::renderer {
namespace {

using image::InverseDepthPicture;
using image::RowCode;

constexpr RowCode kCodes[] = {RowCode::kBaseline, RowCode::kAvx2};

bool is_there(RowCode code) {
    return code == RowCode::kBaseline || image::best_row_code() == RowCode::kAvx2;
}

class Random {
public:
    explicit Random(unsigned seed) : engine_(seed) {}
    float between(float low, float high) {
        return std::uniform_real_distribution<float>(low, high)(engine_);
    }
    std::uint32_t number() { return static_cast<std::uint32_t>(engine_()); }
    Axes points(std::size_t size, float reach) {
        Axes axes;
        axes.resize(size);
        for (auto* values : {&axes.x, &axes.y, &axes.z})
            for (float& value : *values) value = between(-reach, reach);
        return axes;
    }

private:
    std::mt19937 engine_;
};

TEST(PersonRows, ProjectsLikeTheCamera) {
    auto camera = synthetic::camera_at({3.0, 0.5, 1.0}, {0.0, 0.0, 0.0});
    camera.intrinsics.distortion = {-0.2, 0.05, 0.001, -0.002, 0.01};
    const auto& lens = camera.intrinsics;
    Projection projection{};
    Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(projection.rotation.data()) =
        camera.camera_from_site.rotation.toRotationMatrix().cast<float>();
    Eigen::Map<Eigen::Vector3f>(projection.translation.data()) =
        camera.camera_from_site.translation.cast<float>();
    projection.fx = static_cast<float>(lens.fx);
    projection.fy = static_cast<float>(lens.fy);
    projection.cx = static_cast<float>(lens.cx);
    projection.cy = static_cast<float>(lens.cy);
    projection.skew = static_cast<float>(lens.skew);
    for (std::size_t i = 0; i < 5; ++i)
        projection.distortion[i] = static_cast<float>(lens.distortion[i]);
    projection.st_per_px = {1.0f, 1.0f};
    const Axes points = Random(1).points(1003, 1.0f);
    Projected first;
    for (const RowCode code : kCodes) {
        if (!is_there(code)) continue;
        Projected out;
        project_points(projection, points, out, code);
        for (std::size_t v = 0; v < points.size(); ++v) {
            const Eigen::Vector3d p =
                camera.camera_from_site * Eigen::Vector3d(points.x[v], points.y[v], points.z[v]);
            const Eigen::Vector2d px = lens.project(p);
            const Eigen::Vector2d bent = lens.distort(px);
            ASSERT_NEAR(out.undistorted.x[v], px.x(), 2e-3);
            ASSERT_NEAR(out.undistorted.y[v], px.y(), 2e-3);
            ASSERT_NEAR(out.undistorted.z[v], 1.0 / p.z(), 1e-6);
            ASSERT_NEAR(out.in_layer.x[v] / out.in_layer.z[v], bent.x(), 2e-3);
            ASSERT_NEAR(out.in_layer.y[v] / out.in_layer.z[v], bent.y(), 2e-3);
        }
        if (code == RowCode::kBaseline) first = out;
        EXPECT_EQ(out.undistorted.x, first.undistorted.x);
        EXPECT_EQ(out.undistorted.z, first.undistorted.z);
        EXPECT_EQ(out.in_layer.x, first.in_layer.x);
        EXPECT_EQ(out.in_layer.y, first.in_layer.y);
    }
}

TEST(PersonRows, ReadsTexelsByCoordinateAndTheBorderElsewhere) {
    Projection projection{};
    projection.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    projection.translation = {0, 0, 2.5f};
    projection.fx = projection.fy = 100.0f;
    projection.st_per_px = {0.01f, 0.02f};
    projection.st_offset = {0.5f, 0.5f};
    projection.layer_size = {64, 48};
    const Axes points = Random(7).points(1001, 2.0f);
    int num_within = 0;
    for (const RowCode code : kCodes) {
        if (!is_there(code)) continue;
        Projected out;
        project_points(projection, points, out, code);
        for (std::size_t v = 0; v < points.size(); ++v) {
            const float x = out.in_layer.x[v] / out.in_layer.z[v] * 64.0f;
            const float y = out.in_layer.y[v] / out.in_layer.z[v] * 48.0f;
            const int column = out.texels[v] % 64, row = out.texels[v] / 64;
            ASSERT_TRUE(0 <= out.texels[v] && row < 48);
            if (x > 0.01f && y > 0.01f && x < 63.9f && y < 47.9f) {
                ASSERT_NEAR(static_cast<float>(column) + 0.5f, x, 0.51f);
                ASSERT_NEAR(static_cast<float>(row) + 0.5f, y, 0.51f);
                ++num_within;
            } else {
                ASSERT_TRUE(column == 0 || column == 63 || row == 0 || row == 47);
            }
        }
    }
    EXPECT_GT(num_within, 100);
}

TEST(PersonRows, NormalisesVectorsAndKeepsZero) {
    Axes first;
    for (const RowCode code : kCodes) {
        if (!is_there(code)) continue;
        Axes vectors = Random(8).points(333, 1e-3f);
        set(vectors, 5, Eigen::Vector3f::Zero());
        const Axes before = vectors;
        normalize(vectors, code);
        for (std::size_t i = 0; i < vectors.size(); ++i) {
            const Eigen::Vector3f was(before.x[i], before.y[i], before.z[i]);
            const Eigen::Vector3f is(vectors.x[i], vectors.y[i], vectors.z[i]);
            ASSERT_LT((is - was.normalized()).norm(), 1e-6f);
        }
        if (code == RowCode::kBaseline) first = vectors;
        EXPECT_EQ(vectors.x, first.x);
        EXPECT_EQ(vectors.z, first.z);
    }
}

TEST(PersonRows, GrazedOrHiddenVerticesCountLess) {
    Random random(9);
    Seen all;
    all.reserve(500);
    all.size = 499;
    for (std::uint32_t i = 0; i < 500; ++i) {
        all.vertices[i] = 499 - i;
        all.cosines[i] = random.between(0.031f, 1.0f);
        all.inverse_depths[i] = random.between(0.2f, 1.0f);
        all.nearest[i] = all.inverse_depths[i] * random.between(0.99f, 1.03f);
        all.masks[i] = random.between(0.1f, 1.0f);
    }
    const Seeing seeing{{0.03f, 0.2f}, 0.012f, 0.02f, 0.003f};
    std::vector<float> first;
    for (const RowCode code : kCodes) {
        if (!is_there(code)) continue;
        Seen seen = all;
        std::vector<float> quality(500, -1.0f);
        judge_seen(seeing, seen, quality, code);
        for (std::size_t i = 0; i < all.size; ++i) {
            const double cosine = all.cosines[i];
            const double depth = 1.0 / all.inverse_depths[i];
            const double behind = depth - 1.0 / all.nearest[i];
            const double slope = std::sqrt(1.0 - cosine * cosine) / cosine;
            const double bias = 0.012 + 1.5 * depth * 0.003 * std::min(slope, 4.0);
            const double hidden = std::clamp((behind - bias) / 0.02, 0.0, 1.0);
            const double t = std::clamp((cosine - 0.03) / 0.17, 0.0, 1.0);
            const double expected = t * t * (3.0 - 2.0 * t) * all.masks[i] * (1.0 - hidden);
            ASSERT_NEAR(quality[all.vertices[i]], expected, 1e-4);
        }
        EXPECT_EQ(quality[0], -1.0f) << "outside the picture";
        if (code == RowCode::kBaseline) first = quality;
        EXPECT_EQ(quality, first);
    }
}

TEST(PersonRows, FacingIsEqualForAllInstructionSets) {
    Random random(2);
    Faces faces{random.points(777, 2.0f), random.points(777, 1.0f)};
    std::vector<float> cosines[2], facing[2];
    for (std::size_t i = 0; i < 2; ++i) {
        if (!is_there(kCodes[i])) return;
        judge_facing(faces, {3.0f, 0.0f, 1.0f}, {0.03f, 0.2f}, cosines[i], facing[i], kCodes[i]);
    }
    EXPECT_EQ(cosines[0], cosines[1]);
    EXPECT_EQ(facing[0], facing[1]);
    for (std::size_t t = 0; t < facing[0].size(); ++t) {
        if (cosines[0][t] <= 0.03f) {
            EXPECT_EQ(facing[0][t], 0.0f);
        }
        if (cosines[0][t] >= 0.2f) {
            EXPECT_FLOAT_EQ(facing[0][t], 1.0f);
        }
    }
}

TEST(PersonRows, MultipliesByTheMaskPerPixel) {
    Random random(3);
    for (const std::size_t width : {1U, 2U, 3U, 17U, 250U}) {
        std::vector<std::uint32_t> rows[3];
        for (auto& row : rows) {
            for (std::size_t x = 0; x < width; ++x) {
                const std::uint32_t alpha = random.number() % 4 == 0 ? 100U : 200U;
                row.push_back((random.number() & 0x00ffffffU) | (alpha << 24U));
            }
        }
        const auto is_masked = [](std::uint32_t rgba) { return rgba >> 24U >= 128U; };
        for (const bool has_above : {false, true}) {
            std::vector<std::uint32_t> expected;
            for (std::size_t x = 0; x < width; ++x) {
                const std::uint32_t here = rows[1][x];
                const bool is_inside = has_above && x > 0 && x + 1 < width &&
                                       is_masked(rows[1][x - 1]) && is_masked(rows[1][x + 1]) &&
                                       is_masked(rows[0][x]) && is_masked(rows[2][x]);
                const std::uint32_t alpha = is_inside ? 255U : kOutlineAlpha;
                std::uint32_t texel = alpha << 24U;
                for (const unsigned shift : {0U, 8U, 16U})
                    texel |= ((((here >> shift) & 255U) * alpha + 127U) / 255U) << shift;
                expected.push_back(is_masked(here) ? texel : 0U);
            }
            for (const RowCode code : kCodes) {
                if (!is_there(code)) continue;
                std::vector<std::uint32_t> out(width, 1U);
                multiply_by_mask(has_above ? rows[0].data() : nullptr,
                                 rows[1],
                                 rows[2].data(),
                                 out.data(),
                                 code);
                EXPECT_EQ(out, expected) << width;
            }
        }
    }
}

TEST(PersonRows, MultipliesColoursUpToWhite) {
    Random random(4);
    std::vector<std::uint32_t> texels(301);
    for (auto& texel : texels) texel = random.number();
    const std::array<double, 3> gains = {0.83, 1.0, 1.31};
    std::array<std::uint32_t, 3> factors{};
    for (std::size_t i = 0; i < 3; ++i)
        factors[i] = static_cast<std::uint32_t>(gains[i] * 65536.0 + 0.5);
    for (const RowCode code : kCodes) {
        if (!is_there(code)) continue;
        auto out = texels;
        multiply_colours(out, factors, code);
        for (std::size_t i = 0; i < texels.size(); ++i) {
            EXPECT_EQ(out[i] >> 24U, texels[i] >> 24U);
            for (std::size_t channel = 0; channel < 3; ++channel) {
                const double before = (texels[i] >> (8U * channel)) & 255U;
                EXPECT_NEAR((out[i] >> (8U * channel)) & 255U,
                            std::min(255.0, before * gains[channel]),
                            0.51);
            }
        }
    }
}

TEST(InverseDepth, FitsThePointsInFrontOfTheCameraWithABorder) {
    Random random(6);
    Axes points = random.points(205, 300.0f);
    for (float& x : points.x) x *= 0.5f;
    for (std::size_t i = 0; i < points.size(); ++i)
        points.z[i] = i % 7 == 0 ? 0.0f : random.between(0.1f, 1.0f);
    points.x[0] = 9000.0f;  // behind the camera
    points.y[203] = -1000.0f;
    std::vector<Eigen::Vector4f> first;
    for (const RowCode code : kCodes) {
        if (!is_there(code)) continue;
        std::vector<Eigen::Vector4f> corners;
        InverseDepthPicture picture;
        fit_inverse_depth(points, 100, corners, picture, code);
        EXPECT_GE(picture.height, 100);
        EXPECT_LE(picture.height, 104);
        EXPECT_LT(picture.width, picture.height);
        ASSERT_EQ(corners.size(), points.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            ASSERT_EQ(corners[i].z(), points.z[i]);
            if (i % 7 == 0) continue;
            ASSERT_TRUE(corners[i].x() > 0.99f && corners[i].y() > 0.99f);
            ASSERT_LT(corners[i].x() + 0.5f, static_cast<float>(picture.width - 1));
            ASSERT_LT(corners[i].y() + 0.5f, static_cast<float>(picture.height - 1));
            const Eigen::Vector2f place = picture.place_of({points.x[i], points.y[i]});
            ASSERT_LT((corners[i].head<2>() - place).cwiseAbs().maxCoeff(), 1e-3);
        }
        if (code == RowCode::kBaseline) first = corners;
        EXPECT_EQ(corners, first);
    }
    std::fill(points.z.begin(), points.z.end(), 0.0f);
    std::vector<Eigen::Vector4f> corners;
    InverseDepthPicture picture;
    fit_inverse_depth(points, 100, corners, picture);
    EXPECT_EQ(picture.scale, 1.0f);
    EXPECT_EQ(picture.width * picture.height, 1);
}

TEST(InverseDepth, IsTheNearestFacingTriangleForAllInstructionSets) {
    Random random(5);
    std::vector<Eigen::Vector4f> corners;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (std::uint32_t t = 0; t < 301; ++t) {
        const float x = random.between(0.0f, 60.0f), y = random.between(0.0f, 90.0f);
        for (int i = 0; i < 3; ++i)
            corners.emplace_back(x + random.between(-9.0f, 9.0f),
                                 y + random.between(-9.0f, 9.0f),
                                 random.between(t % 50 == 0 ? -1.0f : 0.2f, 1.0f),
                                 0.0f);
        triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    // pixels on an edge may be rounded to either side: one set is certainly covered, one possibly
    std::vector<float> least(61 * 91, 0.0f), most = least;
    for (const auto& [ia, ib, ic] : triangles) {
        const Eigen::Vector4d a = corners[ia].cast<double>(), b = corners[ib].cast<double>(),
                              c = corners[ic].cast<double>();
        if (!(a.z() > 0 && b.z() > 0 && c.z() > 0)) continue;
        Eigen::Matrix2d edges;
        edges << (b - a).head<2>(), (c - a).head<2>();
        if (!(edges.determinant() < 0.0)) continue;
        const Eigen::Matrix2d weights_of = edges.inverse();
        for (int y = 0; y < 91; ++y) {
            for (int x = 0; x < 61; ++x) {
                const Eigen::Vector2d w = weights_of * (Eigen::Vector2d(x, y) - a.head<2>());
                const double inside = std::min({w.x(), w.y(), 1.0 - w.sum()});
                const auto value =
                    static_cast<float>(a.z() + w.x() * (b.z() - a.z()) + w.y() * (c.z() - a.z()));
                const auto i = static_cast<std::size_t>(61 * y + x);
                if (inside > 1e-3) least[i] = std::max(least[i], value);
                if (inside > -1e-3) most[i] = std::max(most[i], value);
            }
        }
    }
    InverseDepthPicture first;
    for (const RowCode code : kCodes) {
        if (!is_there(code)) continue;
        InverseDepthPicture picture{.width = 61, .height = 91, .values = {}};
        draw_inverse_depth(corners, triangles, picture, code);
        for (int y = 0; y < 91; ++y) {
            for (int x = 0; x < 61; ++x) {
                const auto i = static_cast<std::size_t>(61 * y + x);
                ASSERT_GE(picture.at(x, y), least[i] - 1e-3f) << x << " " << y;
                ASSERT_LE(picture.at(x, y), most[i] + 1e-3f) << x << " " << y;
            }
        }
        if (code == RowCode::kBaseline) first = picture;
        EXPECT_EQ(picture.values, first.values);

        for (int y = 1; y < 90; ++y) {
            for (int x = 1; x < 60; ++x) {
                float nearest = 0.0f;
                for (int py = y - 1; py <= y + 1; ++py)
                    for (int px = x - 1; px <= x + 1; ++px)
                        nearest = std::max(nearest, picture.at(px, py));
                ASSERT_EQ(picture.nearest_around(x, y), nearest);
            }
        }
    }
}

TEST(ChooseCameras, GivesTheSameBitsForAllInstructionSets) {
    if (!is_there(RowCode::kAvx2)) GTEST_SKIP() << atrium::test::skip::kNoAvx2;
    const std::vector<synthetic::Sphere> body{{{0.0, 0.0, 1.0}, 0.5}};
    std::vector<CameraPicture> pictures;
    for (const auto& camera : synthetic::ring(7, body.front().centre))
        pictures.push_back(synthetic::picture_of(
            body, camera, [](const auto&) { return Eigen::Vector3d(0.2, 0.7, 0.3); }));
    PersonModelScratch scratch;
    PersonModel model;
    build_person_model(synthetic::mesh_of(body, 20), pictures, {}, scratch, model);
    BlendScratch blends[2];
    for (std::size_t i = 0; i < 2; ++i)
        choose_cameras(model, Eigen::Vector3f(2.0f, 1.0f, 1.5f), blends[i], kCodes[i]);
    EXPECT_EQ(blends[0].candidates, blends[1].candidates);
    EXPECT_EQ(blends[0].weights, blends[1].weights);
}

}  // namespace
}  // namespace atrium::renderer
