#include "world_server/physics/solid_cells.hpp"

#include "meshes.hpp"
#include "world_server/physics/surface_index.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace atrium::physics {
namespace {

using physics_test::make_box_mesh;
using physics_test::make_sphere_mesh;

double reach(const SolidCells& cells, const ConvexPiece& piece, const Eigen::Vector3f& direction) {
    float best = -std::numeric_limits<float>::infinity();
    for (std::uint32_t i = 0; i < piece.num_points; ++i) {
        best = std::max(best, direction.dot(cells.points[piece.first_point + i]));
    }
    return best;
}

TEST(SolidCells, CoverEveryPointInsideABall) {
    const Eigen::Vector3d centre(0.21, -0.4, 1.03);
    const double radius_m = 0.3;
    const SolidCells cells = cut_into_cells(make_sphere_mesh(radius_m, centre, 16), {});

    // the hull of extremes in 26 directions may cut a corner off the ball in a cell: by the sagitta
    // of a cell's diagonal on the ball, at most
    const double slack_m = 0.14 * std::sqrt(2.0) * 0.14 / (8.0 * radius_m) + 0.01;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> coordinate(-radius_m, radius_m);
    for (int trial = 0; trial < 3000; ++trial) {
        const Eigen::Vector3d p(coordinate(random), coordinate(random), coordinate(random));
        if (p.norm() > radius_m - slack_m) continue;
        const std::int32_t index = cells.piece_at(centre + p);
        ASSERT_GE(index, 0) << "no piece at " << p.transpose();
        const ConvexPiece& piece = cells.pieces[static_cast<std::size_t>(index)];
        const Eigen::Vector3f offset = (centre + p).cast<float>() - piece.centre;
        for (int axis = 0; axis < 3; ++axis) {
            const Eigen::Vector3f direction = Eigen::Vector3f::Unit(axis);
            EXPECT_GE(reach(cells, piece, direction) + 1e-3, offset[axis]);
            EXPECT_GE(reach(cells, piece, -direction) + 1e-3, -offset[axis]);
        }
    }
}

TEST(SolidCells, AddUpToTheBoundsOfTheSolidAndNoMore) {
    const Eigen::Vector3d size(0.5, 0.31, 0.77);
    const geometry::RigidTransform pose{
        Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized())),
        {0.3, 0.1, 1.0}};
    const geometry::TriangleMesh mesh = make_box_mesh(size, pose, 3);
    const SolidCells cells = cut_into_cells(mesh, {});
    geometry::Aabb box;
    for (const ConvexPiece& piece : cells.pieces) {
        for (std::uint32_t i = 0; i < piece.num_points; ++i) {
            const Eigen::Vector3d p =
                (piece.centre + cells.points[piece.first_point + i]).cast<double>();
            box.add(p);
            const Eigen::Vector3d p_box = pose.inverse() * p;
            EXPECT_TRUE((p_box.cwiseAbs().array() <= 0.5 * size.array() + 1e-5).all())
                << p_box.transpose();
        }
    }
    const geometry::Aabb truth = geometry::bounds(mesh);
    EXPECT_LT((box.min - truth.min).norm(), 1e-5);
    EXPECT_LT((box.max - truth.max).norm(), 1e-5);
}

TEST(SolidCells, FillTheInside) {
    const SolidCells cells = cut_into_cells(
        make_box_mesh(
            Eigen::Vector3d::Constant(1.0), {Eigen::Quaterniond::Identity(), {0, 0, 1}}, 1),
        {});
    const std::int32_t middle = cells.piece_at({0.0, 0.0, 1.0});
    ASSERT_GE(middle, 0);
    // a cell without any surface is a whole cube
    EXPECT_EQ(cells.pieces[static_cast<std::size_t>(middle)].num_points, 8U);
}

TEST(SolidCells, BecomeLargerWhenTheyWouldBeTooMany) {
    const SolidCells cells =
        cut_into_cells(make_box_mesh(Eigen::Vector3d::Constant(5.0), geometry::RigidTransform{}, 2),
                       {.cell_m = 0.14, .max_pieces = 300});
    EXPECT_LE(cells.pieces.size(), 300U);
    EXPECT_GE(cells.pieces.size(), 100U);
}

TEST(SolidCells, OfAnOpenSurfaceAreItsSurfaceAlone) {
    geometry::TriangleMesh mesh =
        make_box_mesh(Eigen::Vector3d::Constant(1.0), geometry::RigidTransform{}, 1);
    std::erase_if(mesh.triangles, [&](const auto& t) {  // the lid
        return std::all_of(t.begin(), t.end(), [&](auto v) { return mesh.vertices[v].z() > 0.4; });
    });
    const SolidCells cells = cut_into_cells(mesh, {});
    EXPECT_EQ(cells.piece_at({0.0, 0.0, 0.0}), -1);
    EXPECT_GE(cells.piece_at({0.0, 0.0, -0.499}), 0);
}

TEST(SolidCells, DoNotDependOnTheOrderOfTheTriangles) {
    geometry::TriangleMesh mesh = make_sphere_mesh(0.25, {0, 0, 1}, 9);
    const SolidCells a = cut_into_cells(mesh, {});
    std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), std::mt19937(3));
    const SolidCells b = cut_into_cells(mesh, {});
    ASSERT_EQ(a.pieces.size(), b.pieces.size());
    for (std::size_t i = 0; i < a.pieces.size(); ++i) EXPECT_EQ(a.pieces[i].cell, b.pieces[i].cell);
}

TEST(SolidCells, AreNoneOfAnEmptyMesh) {
    EXPECT_TRUE(cut_into_cells({}, {}).pieces.empty());
    EXPECT_EQ(cut_into_cells({}, {}).piece_at({0, 0, 0}), -1);
}

TEST(SurfaceIndex, FindsTheSampleThatALinearSearchFinds) {
    const geometry::TriangleMesh mesh = physics_test::make_person_mesh({0, 0, 0}, 0.5, 12);
    const SurfaceIndex index(mesh, {});
    ASSERT_GT(index.samples().size(), 2000U);
    std::mt19937 random(11);
    std::uniform_real_distribution<float> coordinate(-0.6F, 1.9F);
    int num_found = 0;
    for (int trial = 0; trial < 1500; ++trial) {
        const Eigen::Vector3f p(coordinate(random), coordinate(random), coordinate(random));
        const auto facing_up = [](const SurfaceSample& s) { return s.normal.z() > 0.3F; };
        float best = 0.3F;
        for (const SurfaceSample& s : index.samples()) {
            if (facing_up(s)) best = std::min(best, (s.position - p).norm());
        }
        const auto found = index.nearest(p, 0.3F, facing_up);
        ASSERT_EQ(found.has_value(), best < 0.3F);
        if (!found) continue;
        ++num_found;
        EXPECT_FLOAT_EQ((found->position - p).norm(), best);
    }
    EXPECT_GT(num_found, 30);
}

}  // namespace
}  // namespace atrium::physics
