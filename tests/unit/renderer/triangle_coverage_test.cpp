#include "viewer/renderer/drawing/triangle_coverage.hpp"

#include "viewer/renderer/backdrop/floor_cells.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace atrium::renderer {
namespace {

class FindCovered : public testing::Test {
protected:
    static constexpr int kSide = 40;
    std::vector<Eigen::Vector2f> corners_;
    std::vector<std::array<std::uint32_t, 3>> triangles_;
    CoverageScratch scratch_;
    std::vector<PixelRun> runs_;

    void find() { find_covered(corners_, triangles_, kSide, scratch_, runs_); }
    int times_in_runs(int x, int y) const {
        int times = 0;
        for (const PixelRun& run : runs_) times += run.row == y && run.begin <= x && x < run.end;
        return times;
    }
};

TEST_F(FindCovered, FindsThePixelsInsideTrianglesOfAnySizeAndOrientation) {
    std::mt19937 random(3);
    const auto between = [&](float low, float high) {
        return std::uniform_real_distribution<float>(low, high)(random);
    };
    for (std::uint32_t t = 0; t < 120; ++t) {
        const Eigen::Vector2f middle(between(-8.0f, 48.0f), between(-8.0f, 48.0f));
        const float size = t < 100 ? 1.5f : 6.0f;
        for (int i = 0; i < 3; ++i)
            corners_.push_back(middle +
                               Eigen::Vector2f(between(-size, size), between(-size, size)));
        triangles_.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    find();
    int num_covered = 0;
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
            // the largest distance inside the edges of any triangle; negative outside
            double inside = -std::numeric_limits<double>::infinity();
            for (const auto& triangle : triangles_) {
                double least = std::numeric_limits<double>::infinity();
                double most = -least;
                for (std::size_t i = 0; i < 3; ++i) {
                    const Eigen::Vector2d a = corners_[triangle[i]].cast<double>();
                    const Eigen::Vector2d b = corners_[triangle[(i + 1) % 3]].cast<double>();
                    const Eigen::Vector2d way = (b - a).normalized();
                    const Eigen::Vector2d to = Eigen::Vector2d(x, y) - a;
                    const double side = way.x() * to.y() - way.y() * to.x();
                    least = std::min(least, side);
                    most = std::max(most, side);
                }
                inside = std::max({inside, least, -most});
            }
            if (std::abs(inside) < 0.05) continue;
            EXPECT_EQ(times_in_runs(x, y), inside > 0.0 ? 1 : 0) << x << " " << y;
            num_covered += inside > 0.0 ? 1 : 0;
        }
    }
    EXPECT_GT(num_covered, 100);
    EXPECT_LT(num_covered, 1400);
}

TEST_F(FindCovered, LeavesNoGapBetweenNeighbours) {
    // a fan around a point, whose edges pass near many pixel centres
    corners_.emplace_back(20.0f, 20.0f);
    constexpr std::uint32_t kSides = 97;
    for (std::uint32_t i = 0; i < kSides; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / kSides;
        corners_.emplace_back(static_cast<float>(20.0 + 15.0 * std::cos(angle)),
                              static_cast<float>(20.0 + 15.0 * std::sin(angle)));
        triangles_.push_back({0, 1 + i, 1 + (i + 1) % kSides});
    }
    find();
    EXPECT_EQ(runs_.size(), 29u) << "one in each row from 6 to 34";
}

TEST_F(FindCovered, SurvivesNonFiniteCorners) {
    const float no_number = std::numeric_limits<float>::quiet_NaN();
    const float endless = std::numeric_limits<float>::infinity();
    corners_ = {{no_number, 3.0f},
                {5.0f, no_number},
                {9.0f, 9.0f},
                {-endless, endless},
                {1e30f, -1e30f},
                {2.0f, 30.0f}};
    for (std::uint32_t i = 0; i < 6; ++i)
        for (std::uint32_t j = 0; j < 6; ++j)
            for (std::uint32_t k = 0; k < 6; ++k) triangles_.push_back({i, j, k});
    find();
    for (const PixelRun& run : runs_) {
        EXPECT_TRUE(0 <= run.row && run.row < kSide);
        EXPECT_TRUE(0 <= run.begin && run.begin < run.end && run.end <= kSide);
    }
    triangles_.clear();
    find();
    EXPECT_TRUE(runs_.empty());
}

// Twice the summed area of the triangles, and the bounds of their corners.
std::pair<double, Eigen::AlignedBox2d> cover_of(const std::vector<Eigen::Vector3f>& triangles) {
    double twice_area = 0.0;
    Eigen::AlignedBox2d bounds;
    for (std::size_t i = 0; i < triangles.size(); i += 3) {
        const Eigen::Vector3f to = triangles[i + 1] - triangles[i];
        twice_area += std::abs(to.cross(triangles[i + 2] - triangles[i]).z());
        for (std::size_t k = i; k < i + 3; ++k)
            bounds.extend(triangles[k].head<2>().cast<double>());
    }
    return {twice_area, bounds};
}

TEST(FloorCells, AreTheTouchedCellsOnceEach) {
    FloorCells cells(FloorCells::kSide);  // cells of a metre
    EXPECT_TRUE(cells.empty());
    cells.add({Eigen::Vector2d(0.5, -1.5), Eigen::Vector2d(2.5, -0.5)});
    cells.add({Eigen::Vector2d(1.5, -1.5), Eigen::Vector2d(1.6, 0.5)});
    cells.add({Eigen::Vector2d(20.0, 0.0), Eigen::Vector2d(25.0, 1.0)});      // outside
    cells.add({Eigen::Vector2d(15.5, -90.0), Eigen::Vector2d(99.0, -15.5)});  // in a corner
    EXPECT_FALSE(cells.empty());
    EXPECT_EQ(cells.bounds().min(), Eigen::Vector2d(0.0, -16.0));
    EXPECT_EQ(cells.bounds().max(), Eigen::Vector2d(16.0, 1.0));
    std::vector<Eigen::Vector3f> triangles;
    cells.find_triangles({100.0, 100.0}, {}, triangles);
    const auto [twice_area, bounds] = cover_of(triangles);
    EXPECT_DOUBLE_EQ(twice_area, 2.0 * (6 + 1 + 1));
    EXPECT_EQ(bounds.min(), cells.bounds().min());
    EXPECT_EQ(bounds.max(), cells.bounds().max());
    cells.clear();
    EXPECT_TRUE(cells.empty());
}

TEST(FloorCells, EndAtTheEdgeOfThePlane) {
    FloorCells cells(FloorCells::kSide);
    cells.add({Eigen::Vector2d(-10.0, -10.0), Eigen::Vector2d(10.0, 10.0)});
    const Eigen::AngleAxisd turn(0.6, Eigen::Vector3d::UnitZ());
    const geometry::RigidTransform world_from_plane{Eigen::Quaterniond(turn), {3.3, -2.2, 0.5}};
    std::vector<Eigen::Vector3f> triangles;
    cells.find_triangles({2.25, 1.5}, world_from_plane, triangles);
    EXPECT_NEAR(cover_of(triangles).first, 2.0 * 4.5 * 3.0, 1e-3);
    for (const Eigen::Vector3f& corner : triangles) {
        const Eigen::Vector3d p = world_from_plane.inverse() * corner.cast<double>();
        EXPECT_LE(std::abs(p.x()), 2.25 + 1e-5);
        EXPECT_LE(std::abs(p.y()), 1.5 + 1e-5);
        EXPECT_NEAR(p.z(), 0.0, 1e-6);
    }
}

}  // namespace
}  // namespace atrium::renderer
