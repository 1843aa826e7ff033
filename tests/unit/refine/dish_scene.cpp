#include "tests/unit/refine/dish_scene.hpp"

#include "site_node/hull/visual_hull.hpp"
#include "site_node/silhouette/silhouette.hpp"
#include "tests/support/shapes/bounding_rect.hpp"
#include "tests/support/shapes/rig_maker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace atrium::refine {
namespace {

// A value in [-1, 1] per corner of a lattice.
double lattice_value(int x, int y, int z, std::uint64_t seed) {
    std::uint64_t hash = seed;
    for (const int v : {x, y, z}) {
        hash ^= static_cast<std::uint64_t>(static_cast<std::uint32_t>(v));
        hash *= 0x9E3779B97F4A7C15ULL;
        hash ^= hash >> 29U;
    }
    return static_cast<double>(hash >> 40U) / static_cast<double>(1U << 23U) - 1.0;
}

// Smooth noise.
double pattern(const Eigen::Vector3d& point, double cell_m, std::uint64_t seed) {
    const Eigen::Vector3d p = point / cell_m;
    const Eigen::Vector3d low = p.array().floor();
    const Eigen::Vector3d share = p - low;
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector3i step(corner & 1, (corner >> 1) & 1, corner >> 2);
        const Eigen::Vector3i at = low.cast<int>() + step;
        double weight = 1.0;
        for (int axis = 0; axis < 3; ++axis)
            weight *= step[axis] == 1 ? share[axis] : 1.0 - share[axis];
        sum += weight * lattice_value(at.x(), at.y(), at.z(), seed);
    }
    return sum;
}

std::uint8_t luma_of(const Eigen::Vector3d& point, std::uint64_t seed, double contrast) {
    const double value = 128.0 + contrast * (70.0 * pattern(point, 0.03, seed) +
                                             50.0 * pattern(point, 0.012, seed + 1));
    return static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0));
}

}  // namespace

double Dish::hollow_radius_m() const {
    return (rim_radius_m * rim_radius_m + depth_m * depth_m) / (2.0 * depth_m);
}

double Dish::distance_m(const Eigen::Vector3d& p) const {
    const double side = p.head<2>().norm() - radius_m;
    const double block = std::max({side, p.z() - height_m, -p.z()});
    const double ball_m = hollow_radius_m();
    const Eigen::Vector3d centre(0.0, 0.0, height_m - depth_m + ball_m);
    return std::max(block, ball_m - (p - centre).norm());
}

std::vector<PictureView> DishScene::views() const {
    std::vector<PictureView> views;
    for (std::size_t i = 0; i < cameras.size(); ++i)
        views.push_back({&cameras[i], pictures[i], &masks[i], subjects[i]});
    return views;
}

DishScene film_dish(const Dish& dish, std::uint64_t seed, double contrast) {
    DishScene scene;
    scene.cameras = test::make_ring_rig({.num_cameras = 9,
                                         .radius_m = 1.6,
                                         .heights_m = {0.15, 1.4, 1.7},
                                         .target_site = {0.0, 0.0, 0.1},
                                         .first_angle_rad = 0.2,
                                         .size_px = 400,
                                         .focal_px = 800.0});
    std::vector<hull::SilhouetteView> outlines;
    silhouette::SilhouetteScratch silhouette_scratch;
    std::vector<silhouette::SilhouettePolygon> polygons;
    for (const geometry::CalibratedCamera& camera : scene.cameras) {
        const int size = camera.intrinsics.width;
        image::YuvImage picture{image::Plane(size, size, 90),
                                image::Plane(size / 2, size / 2, 128),
                                image::Plane(size / 2, size / 2, 128)};
        image::Mask mask(size, size);
        const Eigen::Vector3d eye = camera.centre_site();
        const Eigen::Quaterniond site_from_camera = camera.camera_from_site.inverse().rotation;
        for (int y = 0; y < size; ++y) {
            for (int x = 0; x < size; ++x) {
                const Eigen::Vector3d ray =
                    (site_from_camera * camera.intrinsics.ray_camera({x, y})).normalized();
                constexpr double kMostDistance_m = 3.0;
                constexpr double kTouch_m = 1e-5;
                double along = 1.0;
                double left = dish.distance_m(eye + along * ray);
                while (left > kTouch_m && along < kMostDistance_m) {
                    along += left;
                    left = dish.distance_m(eye + along * ray);
                }
                if (left > kTouch_m) continue;
                mask.row(y)[x] = 255;
                picture.y.row(y)[x] = luma_of(eye + along * ray, seed, contrast);
            }
        }
        silhouette::extract_silhouette(mask, camera.intrinsics, {}, silhouette_scratch, polygons);
        hull::SilhouetteView view{camera.intrinsics, camera.camera_from_site, {}, {}};
        for (const auto& polygon : polygons) view.contours.push_back(polygon.vertices_px);
        scene.contours.push_back(view.contours);
        outlines.push_back(std::move(view));
        scene.subjects.push_back(test::bounding_rect(mask));
        scene.pictures.push_back(std::move(picture));
        scene.masks.push_back(std::move(mask));
    }
    hull::HullScratch scratch;
    hull::VisualHull hull = hull::compute_visual_hull(outlines, {}, scratch);
    EXPECT_EQ(hull.status, hull::HullStatus::kOk);
    scene.hull = std::move(hull.mesh);
    return scene;
}

}  // namespace atrium::refine
