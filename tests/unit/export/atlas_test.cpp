#include "tests/support/random.hpp"
#include "tests/unit/export/ball_person.hpp"
#include "tools/export/atlas/bake.hpp"
#include "tools/export/atlas/charts.hpp"
#include "tools/export/atlas/fill_gaps.hpp"
#include "tools/export/atlas/packing.hpp"
#include "tools/export/atlas/projections.hpp"
#include "tools/export/atlas/texels_inside.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace atrium::exporting {
namespace {

TEST(Packing, PlacesRectanglesWithoutOverlap) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        test::Random random(seed);
        std::vector<Eigen::Vector2i> sizes;
        const int count = test::between(random, 1, 200);
        for (int i = 0; i < count; ++i)
            sizes.emplace_back(test::between(random, 1, 90), test::between(random, 1, 90));
        const Packing packing = pack(sizes);
        EXPECT_EQ(packing.size.x() % 16, 0);
        EXPECT_EQ(packing.size.y() % 16, 0);
        std::vector<std::uint8_t> is_used(static_cast<std::size_t>(packing.size.x()) *
                                          static_cast<std::size_t>(packing.size.y()));
        std::size_t area = 0;
        for (std::size_t i = 0; i < sizes.size(); ++i) {
            const Eigen::Vector2i& at = packing.places[i];
            ASSERT_GE(at.minCoeff(), 0);
            ASSERT_TRUE(((at + sizes[i]).array() <= packing.size.array()).all()) << seed;
            for (int y = at.y(); y < at.y() + sizes[i].y(); ++y) {
                for (int x = at.x(); x < at.x() + sizes[i].x(); ++x, ++area) {
                    auto& used = is_used[static_cast<std::size_t>(y) *
                                             static_cast<std::size_t>(packing.size.x()) +
                                         static_cast<std::size_t>(x)];
                    ASSERT_EQ(used, 0) << seed;
                    used = 1;
                }
            }
        }
        if (count > 50) {
            EXPECT_GT(static_cast<double>(area), 0.7 * static_cast<double>(is_used.size()));
        }
    }
}

TEST(TexelsInside, CoverATriangleAndItsMargin) {
    const std::array<Eigen::Vector2f, 3> corners{
        Eigen::Vector2f{2, 2}, Eigen::Vector2f{8.2f, 2}, Eigen::Vector2f{2, 8.2f}};
    const auto count = [&](float margin) {
        int number = 0;
        for_texels_inside(corners, margin, [&](int x, int y, const Eigen::Vector3f& shares) {
            ++number;
            const Eigen::Vector2f centre(static_cast<float>(x) + 0.5f,
                                         static_cast<float>(y) + 0.5f);
            const Eigen::Vector2f mixed =
                shares[0] * corners[0] + shares[1] * corners[1] + shares[2] * corners[2];
            EXPECT_LT((mixed - centre).norm(), 1e-4f);
        });
        return number;
    };
    EXPECT_EQ(count(0.0f), 21);
    EXPECT_EQ(count(-0.2f), 15) << "those at the long edge are 0.14 texels inside";
    EXPECT_GT(count(1.0f), 40);
}

TEST(Charts, DoNotCoverThemselves) {
    const renderer::PersonModel model = testing::ball_model();
    const Charts charts = find_charts(model, 1.0f);
    const Projections projections = find_projections(model, 1.0f);
    ASSERT_EQ(charts.chart_of.size(), model.triangles.size());
    // two charts per camera and ball, and some of the faces that no camera sees
    EXPECT_LT(charts.charts.size(), 60u);
    std::map<std::tuple<std::uint32_t, int, int>, std::uint32_t> owners;
    for (std::uint32_t t = 0; t < model.triangles.size(); ++t) {
        ASSERT_LT(charts.chart_of[t], charts.charts.size());
        const Charts::Chart& chart = charts.charts[charts.chart_of[t]];
        for (const Eigen::Vector2f& place : charts.places[t]) {
            EXPECT_TRUE((place.array() >= chart.low.cast<float>().array() + 2.9f).all());
            EXPECT_TRUE(
                (place.array() <= (chart.low + chart.size).cast<float>().array() - 2.9f).all());
        }
        if (projections.is_thin[t] != 0) continue;
        const auto& [a, b, c] = charts.places[t];
        EXPECT_LT(twice_area(a, b, c), 0.0f) << "faces its camera";
        std::array<Eigen::Vector2f, 3> moved;  // texels are counted from 0
        for (std::size_t i = 0; i < 3; ++i)
            moved[i] = charts.places[t][i] - chart.low.cast<float>();
        for_texels_inside(moved, -0.1f, [&](int x, int y, const Eigen::Vector3f&) {
            EXPECT_TRUE(owners.emplace(std::tuple(charts.chart_of[t], x, y), t).second);
        });
    }
}

TEST(Charts, KnowWhoIsBesideATriangle) {
    const auto beyond = neighbours({{0, 1, 2}, {2, 1, 3}, {4, 5, 6}});
    EXPECT_EQ(beyond[0], (std::array<std::uint32_t, 3>{kNoTriangle, 1, kNoTriangle}));
    EXPECT_EQ(beyond[1], (std::array<std::uint32_t, 3>{0, kNoTriangle, kNoTriangle}));
    EXPECT_EQ(beyond[2], (std::array<std::uint32_t, 3>{kNoTriangle, kNoTriangle, kNoTriangle}));
}

TEST(FillGaps, ContinuesKnownColours) {
    Picture picture{32, 16, std::vector<std::uint8_t>(4 * 32 * 16, 7)};
    std::vector<std::uint8_t> is_known(32 * 16, 0);
    const auto set_pixel = [&](std::size_t texel, std::array<std::uint8_t, 3> colour) {
        is_known[texel] = 1;
        std::ranges::copy(colour, picture.rgba.begin() + static_cast<std::ptrdiff_t>(4 * texel));
    };
    for (std::size_t y = 0; y < 16; ++y) {
        for (std::size_t x = 0; x < 8; ++x) set_pixel(32 * y + x, {200, 40, 10});
        for (std::size_t x = 24; x < 32; ++x) set_pixel(32 * y + x, {10, 40, 200});
    }
    fill_gaps(is_known, picture);
    for (std::size_t i = 0; i < is_known.size(); ++i) {
        EXPECT_EQ(picture.rgba[4 * i + 1], 40);
        EXPECT_EQ(picture.rgba[4 * i + 3], 255);
    }
    EXPECT_GT(picture.rgba[4 * (32 * 5 + 8)], 150) << "beside red";
    EXPECT_LT(picture.rgba[4 * (32 * 5 + 23)], 60) << "beside blue";
}

TEST(FillGaps, IsGreyWithoutAnyColour) {
    Picture picture{4, 4, std::vector<std::uint8_t>(64, 0)};
    fill_gaps(std::vector<std::uint8_t>(16, 0), picture);
    for (std::size_t i = 0; i < picture.rgba.size(); ++i)
        EXPECT_EQ(picture.rgba[i], i % 4 == 3 ? 255 : 128);
}

// Nearest texel of a texture coordinate.
Eigen::Vector3d texel_of(const Picture& picture, const Eigen::Vector2f& uv) {
    const int x = std::clamp(
        static_cast<int>(uv.x() * static_cast<float>(picture.width)), 0, picture.width - 1);
    const int y = std::clamp(
        static_cast<int>(uv.y() * static_cast<float>(picture.height)), 0, picture.height - 1);
    const std::uint8_t* rgba = picture.rgba.data() + 4 * (y * picture.width + x);
    return Eigen::Vector3d(rgba[0], rgba[1], rgba[2]) / 255.0;
}

// All cameras see the upper half of the large ball from the side or above.
bool is_seen_well(const Eigen::Vector3d& p) {
    return p.z() > 0.85 && testing::off_surface_m(p) < 0.02 && p.x() < 0.3;
}

TEST(Bake, TextureHasTheColoursOfTheSurface) {
    const renderer::PersonModel model = testing::ball_model();
    const TexturedMesh mesh = bake(model);
    ASSERT_EQ(mesh.triangles.size(), model.triangles.size());
    ASSERT_EQ(mesh.positions.size(), model.vertices_site.size());
    ASSERT_EQ(mesh.uvs.size(), mesh.position_of.size());
    EXPECT_LT(mesh.uvs.size(), 2 * mesh.positions.size());
    double sum = 0.0;
    double worst = 0.0;
    int count = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (std::size_t i = 0; i < 3; ++i)
            EXPECT_EQ(mesh.position_of[mesh.triangles[t][i]], model.triangles[t][i]);
        const auto& [a, b, c] = mesh.triangles[t];
        const auto position = [&](std::uint32_t v) { return mesh.positions[mesh.position_of[v]]; };
        const Eigen::Vector3d centre =
            ((position(a) + position(b) + position(c)) / 3.0f).cast<double>();
        if (!is_seen_well(centre)) continue;
        const Eigen::Vector2f uv = (mesh.uvs[a] + mesh.uvs[b] + mesh.uvs[c]) / 3.0f;
        const double error = (texel_of(mesh.texture, uv) - testing::colour_at(centre)).norm();
        sum += error;
        worst = std::max(worst, error);
        ++count;
    }
    ASSERT_GT(count, 400);
    EXPECT_LT(sum / count, 0.03);  // a texel of 1.2 cm changes the colour by 0.02
    EXPECT_LT(worst, 0.15);
}

TEST(Bake, LeavesNoForeignColourBetweenCharts) {
    const TexturedMesh mesh = bake(testing::ball_model());
    for (std::size_t i = 0; i < mesh.texture.rgba.size(); i += 4) {
        for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_GE(mesh.texture.rgba[i + c], 40);
            ASSERT_LE(mesh.texture.rgba[i + c], 215);
        }
        ASSERT_EQ(mesh.texture.rgba[i + 3], 255);
    }
}

TEST(Bake, IsDeterministic) {
    const TexturedMesh first = bake(testing::ball_model());
    const TexturedMesh second = bake(testing::ball_model());
    EXPECT_EQ(first.texture.rgba, second.texture.rgba);
    EXPECT_EQ(first.triangles, second.triangles);
    EXPECT_EQ(first.uvs, second.uvs);
}

TEST(Bake, TakesAPersonWithoutPicturesOrTriangles) {
    renderer::PersonModelScratch scratch;
    renderer::PersonModel model;
    renderer::build_person_model(
        renderer::synthetic::mesh_of(testing::balls(), 6), {}, {}, scratch, model);
    const TexturedMesh mesh = bake(model);
    EXPECT_EQ(mesh.triangles.size(), model.triangles.size());
    EXPECT_GT(mesh.texture.width, 0);
    renderer::build_person_model({}, {}, {}, scratch, model);
    EXPECT_TRUE(bake(model).triangles.empty());
    EXPECT_TRUE(sample(model, 100).positions.empty());
    EXPECT_TRUE(colour_vertices(model).positions.empty());
}

// Not by the sites of Atrium, but by a file from anywhere.
TEST(Charts, AreBoundedForAMeshThatIsNoPerson) {
    test::Random random(5);
    geometry::TriangleMesh mesh;
    for (std::uint32_t t = 0; t < 600; ++t) {
        for (int i = 0; i < 3; ++i) {
            const double side_m = t % 2 == 0 ? 900.0 : 0.9;
            mesh.vertices.emplace_back(test::between(random, -1000, 1000) * 1e-3 * side_m,
                                       test::between(random, -1000, 1000) * 1e-3 * side_m,
                                       test::between(random, -1000, 1000) * 1e-3 * side_m);
        }
        mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    renderer::PersonModelScratch scratch;
    renderer::PersonModel model;
    renderer::build_person_model(mesh, testing::ball_pictures(), {}, scratch, model);
    // `bake` tries ever smaller scales
    EXPECT_TRUE(find_charts(model, 1.0f).is_too_large);
    const Charts charts = find_charts(model, kLeastScale);
    EXPECT_FALSE(charts.is_too_large);
    std::vector<Eigen::Vector2i> sizes;
    for (const Charts::Chart& chart : charts.charts) sizes.push_back(chart.size);
    EXPECT_LE(pack(sizes).size.maxCoeff(), kMaxTextureSidePx);
}

TEST(ColourVertices, HaveTheColoursOfTheSurface) {
    const ColouredMesh mesh = colour_vertices(testing::ball_model());
    int count = 0;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const Eigen::Vector3d p = mesh.positions[v].cast<double>();
        if (!is_seen_well(p)) continue;
        ++count;
        EXPECT_LT((mesh.colours[v].cast<double>() - testing::colour_at(p)).norm(), 0.08);
    }
    EXPECT_GT(count, 200);
}

TEST(Sample, SpreadsPointsEvenlyOverTheSurface) {
    constexpr std::size_t kCount = 20'000;
    const PointCloud cloud = sample(testing::ball_model(), kCount);
    ASSERT_EQ(cloud.positions.size(), kCount);
    ASSERT_EQ(cloud.normals.size(), kCount);
    ASSERT_EQ(cloud.colours.size(), kCount);
    const auto balls = testing::balls();
    std::array<std::size_t, 8> octants{};
    std::size_t of_small = 0;
    for (std::size_t i = 0; i < kCount; ++i) {
        const Eigen::Vector3d p = cloud.positions[i].cast<double>();
        ASSERT_LT(testing::off_surface_m(p), 0.01);
        EXPECT_NEAR(cloud.normals[i].norm(), 1.0f, 1e-3f);
        const Eigen::Vector3d from_large = p - balls[0].centre;
        if (std::abs(from_large.norm() - balls[0].radius_m) > 0.02) {
            ++of_small;
            continue;
        }
        EXPECT_GT(cloud.normals[i].cast<double>().dot(from_large.normalized()), 0.95);
        ++octants[(from_large.x() > 0 ? 1U : 0U) + (from_large.y() > 0 ? 2U : 0U) +
                  (from_large.z() > 0 ? 4U : 0U)];
    }
    const double share = 0.04 / 0.29;  // of both surfaces: radii 0.2 and 0.5 squared
    EXPECT_NEAR(static_cast<double>(of_small) / kCount, share, 0.01);
    for (const std::size_t octant : octants)
        EXPECT_NEAR(static_cast<double>(octant), kCount * (1 - share) / 8, kCount * 0.005);
}

}  // namespace
}  // namespace atrium::exporting
