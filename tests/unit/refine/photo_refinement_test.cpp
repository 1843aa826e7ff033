#include "site_node/refine/photo_refinement.hpp"

#include "core/base/executor.hpp"
#include "core/image/inverse_depth.hpp"
#include "tests/support/random.hpp"
#include "tests/unit/refine/dish_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace atrium::refine {
namespace {

struct Error {
    double mean_mm = 0.0;
    double largest_mm = 0.0;
    std::size_t num = 0;
};

// Distances of the vertices over the hollow to its surface. Close to the rim, the block's top and
// the hollow are the same for cameras.
Error error_over_hollow(const geometry::TriangleMesh& mesh, const Dish& dish) {
    Error error;
    for (const Eigen::Vector3d& vertex : mesh.vertices) {
        if (vertex.head<2>().norm() > 0.75 * dish.rim_radius_m) continue;
        if (vertex.z() < 0.3 * dish.height_m) continue;
        const double off_mm = 1e3 * std::abs(dish.distance_m(vertex));
        error.mean_mm += off_mm;
        error.largest_mm = std::max(error.largest_mm, off_mm);
        ++error.num;
    }
    error.mean_mm /= static_cast<double>(std::max<std::size_t>(error.num, 1));
    return error;
}

struct Bare {
    double share = 0.0;  // of the masks' pixels, that the mesh does not cover
    int deepest_px = 0;  // how far inside a mask such a pixel lies
};

bool is_inside(const image::Mask& mask, int x, int y, int margin_px) {
    for (int v = y - margin_px; v <= y + margin_px; ++v) {
        for (int u = x - margin_px; u <= x + margin_px; ++u) {
            if (u < 0 || v < 0 || u >= mask.width || v >= mask.height || mask.at(u, v) == 0)
                return false;
        }
    }
    return true;
}

Bare bare_part(const DishScene& scene, const geometry::TriangleMesh& mesh) {
    Bare bare;
    double num = 0.0;
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
        const geometry::CalibratedCamera& camera = scene.cameras[i];
        const image::Mask& mask = scene.masks[i];
        std::vector<Eigen::Vector4f> corners;
        for (const Eigen::Vector3d& vertex : mesh.vertices) {
            const Eigen::Vector3d at =
                camera.camera_from_site.rotation * vertex + camera.camera_from_site.translation;
            const Eigen::Vector2f px = camera.intrinsics.project(at).cast<float>();
            corners.emplace_back(px.x(), px.y(), static_cast<float>(1.0 / at.z()), 0.0F);
        }
        image::InverseDepthPicture drawn;
        drawn.width = mask.width;
        drawn.height = mask.height;
        image::draw_inverse_depth(corners, mesh.triangles, drawn);
        for (int y = 0; y < mask.height; ++y) {
            for (int x = 0; x < mask.width; ++x) {
                if (mask.at(x, y) == 0) continue;
                num += 1.0;
                if (drawn.at(x, y) > 0.0F) continue;
                bare.share += 1.0;
                while (is_inside(mask, x, y, bare.deepest_px)) ++bare.deepest_px;
            }
        }
    }
    bare.share /= num;
    return bare;
}

TEST(PhotoRefinement, FindsTheHollowThatNoSilhouetteShows) {
    const Dish dish;
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
        const DishScene scene = film_dish(dish, seed);
        geometry::TriangleMesh refined = scene.hull;
        SerialExecutor executor;
        PhotoRefinement refinement;
        ASSERT_TRUE(refinement.refine(refined, scene.views(), executor));
        const geometry::MeshReport before = geometry::inspect(scene.hull);
        const geometry::MeshReport after = geometry::inspect(refined);
        EXPECT_TRUE(after.manifold);
        EXPECT_EQ(after.num_components, before.num_components);
        EXPECT_EQ(after.euler_characteristic, before.euler_characteristic);
        EXPECT_LT(after.volume_m3, before.volume_m3);
        const Error hull_error = error_over_hollow(scene.hull, dish);
        const Error error = error_over_hollow(refined, dish);
        ASSERT_GT(error.num, 50U);
        RecordProperty("mean_mm", std::to_string(error.mean_mm));
        EXPECT_LT(error.mean_mm, 10.0) << "of the hull " << hull_error.mean_mm;
    }
}

TEST(PhotoRefinement, KeepsTheSilhouettes) {
    const DishScene scene = film_dish({}, 4);
    geometry::TriangleMesh refined = scene.hull;
    SerialExecutor executor;
    ASSERT_TRUE(PhotoRefinement().refine(refined, scene.views(), executor));
    const Bare with_hull = bare_part(scene, scene.hull);
    const Bare with_refined = bare_part(scene, refined);
    EXPECT_LE(with_refined.share, with_hull.share + 1e-4);
    EXPECT_LE(with_refined.deepest_px, with_hull.deepest_px);
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
        const geometry::CalibratedCamera& camera = scene.cameras[i];
        for (const Eigen::Vector3d& vertex : refined.vertices) {
            const Eigen::Vector3d at =
                camera.camera_from_site.rotation * vertex + camera.camera_from_site.translation;
            const Eigen::Vector2d px = camera.intrinsics.project(at);
            bool is_near_mask = false;  // outlines are polygons: within 2 px
            for (int y = -2; y <= 2; ++y) {
                for (int x = -2; x <= 2; ++x)
                    is_near_mask |= scene.masks[i].at(static_cast<int>(px.x() + 0.5) + x,
                                                      static_cast<int>(px.y() + 0.5) + y) != 0;
            }
            ASSERT_TRUE(is_near_mask) << camera.name << " " << vertex.transpose();
        }
    }
}

TEST(PhotoRefinement, MovesNothingThatHasNoContrast) {
    const DishScene scene = film_dish({}, 5, 0.0);
    geometry::TriangleMesh refined = scene.hull;
    SerialExecutor executor;
    PhotoRefinement refinement;
    ASSERT_TRUE(refinement.refine(refined, scene.views(), executor));
    EXPECT_EQ(refinement.sweep().counts().num_accepted, 0U);
    EXPECT_EQ(refined.vertices, scene.hull.vertices);
    EXPECT_EQ(refined.triangles, scene.hull.triangles);
}

// With other noise in the pictures.
DishScene with_noise(DishScene scene, std::uint64_t seed) {
    constexpr double kNoise = 12.0;  // grey levels
    test::Random random(seed);
    for (image::YuvImage& picture : scene.pictures) {
        for (std::uint8_t& y : picture.y.data) {
            const double noisy = y + test::between(random, -kNoise, kNoise);
            y = static_cast<std::uint8_t>(std::clamp(noisy, 0.0, 255.0));
        }
    }
    return scene;
}

// Mean change of the surface over the hollow from one metaframe to the next, along the vertical.
double flicker_mm(const DishScene& scene, bool remembers) {
    SerialExecutor executor;
    PhotoRefinement refinement;
    NearScratch near;
    std::vector<float> before;
    double sum_mm = 0.0;
    int num = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        const DishScene noisy = with_noise(scene, seed);
        geometry::TriangleMesh mesh = scene.hull;
        if (!remembers) refinement.forget();
        EXPECT_TRUE(refinement.refine(mesh, noisy.views(), executor));
        std::vector<float> now;
        for (const double x : {-0.12, -0.06, 0.0, 0.06, 0.12}) {
            for (const double y : {-0.12, -0.06, 0.0, 0.06, 0.12}) {
                const Eigen::Vector3d place(x, y, Dish().height_m);
                now.push_back(refinement.sweep()
                                  .move_at(place.cast<float>(), Eigen::Vector3f::UnitZ(), near)
                                  .by_m.z());
            }
        }
        for (std::size_t i = 0; i < before.size(); ++i, ++num)
            sum_mm += 1e3 * std::abs(now[i] - before[i]);
        before = now;
    }
    return sum_mm / num;
}

TEST(PhotoRefinement, FlickersLessWithTheMeshBefore) {
    const DishScene scene = film_dish({}, 11, 0.3);
    EXPECT_LT(flicker_mm(scene, true), 0.7 * flicker_mm(scene, false));
}

// Half of the surfels are swept per metaframe.
TEST(PhotoRefinement, FollowsASurfaceThatJumpsInTwoMetaframes) {
    Dish shallow;
    shallow.depth_m = 0.025;
    const DishScene before = film_dish({}, 12);
    const DishScene after = film_dish(shallow, 13);
    SerialExecutor executor;
    PhotoRefinement refinement;
    geometry::TriangleMesh mesh = before.hull;
    ASSERT_TRUE(refinement.refine(mesh, before.views(), executor));
    ASSERT_GT(error_over_hollow(mesh, shallow).mean_mm, 15.0);
    for (const double most_mm : {5.0, 3.0}) {
        mesh = after.hull;
        ASSERT_TRUE(refinement.refine(mesh, after.views(), executor));
        EXPECT_LT(error_over_hollow(mesh, shallow).mean_mm, most_mm);
    }
    geometry::TriangleMesh alone = after.hull;
    ASSERT_TRUE(PhotoRefinement().refine(alone, after.views(), executor));
    EXPECT_LT(error_over_hollow(mesh, shallow).mean_mm,
              error_over_hollow(alone, shallow).mean_mm + 1.0);
}

TEST(PhotoRefinement, RemembersNothingAfterForgetAndAfterAnInstantWithoutAMesh) {
    const DishScene other = film_dish({}, 14);
    const DishScene scene = film_dish({}, 15, 0.3);
    SerialExecutor executor;
    geometry::TriangleMesh alone = scene.hull;
    ASSERT_TRUE(PhotoRefinement().refine(alone, scene.views(), executor));
    for (const char* how : {"remembers", "forget", "no mesh"}) {
        PhotoRefinement refinement;
        geometry::TriangleMesh mesh = other.hull;
        ASSERT_TRUE(refinement.refine(mesh, other.views(), executor));
        if (how == std::string("forget")) refinement.forget();
        if (how == std::string("no mesh")) {
            geometry::TriangleMesh none;
            ASSERT_FALSE(refinement.refine(none, scene.views(), executor));
        }
        mesh = scene.hull;
        ASSERT_TRUE(refinement.refine(mesh, scene.views(), executor));
        EXPECT_EQ(mesh.vertices == alone.vertices, how != std::string("remembers")) << how;
    }
}

TEST(PhotoRefinement, ChangesNothingWithoutTwoPicturesOrForOpenMeshes) {
    const DishScene scene = film_dish({}, 8);
    SerialExecutor executor;
    PhotoRefinement refinement;
    std::vector<PictureView> views = scene.views();
    geometry::TriangleMesh mesh = scene.hull;
    EXPECT_FALSE(refinement.refine(mesh, {}, executor));
    for (std::size_t i = 1; i < views.size(); ++i) views[i].picture = {};
    EXPECT_FALSE(refinement.refine(mesh, views, executor));
    EXPECT_EQ(mesh.vertices, scene.hull.vertices);
    mesh.triangles.pop_back();
    EXPECT_FALSE(refinement.refine(mesh, scene.views(), executor));
    EXPECT_EQ(mesh.vertices, scene.hull.vertices);
    mesh.clear();
    EXPECT_FALSE(refinement.refine(mesh, scene.views(), executor));
}

TEST(PhotoRefinement, WorksWhileSomeCamerasHaveNoPicture) {
    const Dish dish;
    const DishScene scene = film_dish(dish, 9);
    std::vector<PictureView> views = scene.views();
    views[1].picture = {};
    views[1].mask = nullptr;
    SerialExecutor executor;
    geometry::TriangleMesh mesh = scene.hull;
    ASSERT_TRUE(PhotoRefinement().refine(mesh, views, executor));
    EXPECT_TRUE(geometry::inspect(mesh).manifold);
    EXPECT_LT(error_over_hollow(mesh, dish).mean_mm,
              0.5 * error_over_hollow(scene.hull, dish).mean_mm);
}

}  // namespace
}  // namespace atrium::refine
