#include "tests/support/shapes/solid_error.hpp"

#include "core/geometry/surface_tree.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

namespace atrium::test {
namespace {

using Eigen::Vector3d;
using geometry::SurfaceTree;
using geometry::TriangleMesh;

constexpr double kLitres = 1e3;  // per cubic metre
constexpr double kMillimetres = 1e3;

std::vector<Vector3d> points_on(const TriangleMesh& mesh, int num, std::mt19937_64& random) {
    std::vector<double> areas;
    for (const auto& t : mesh.triangles) {
        const Vector3d& a = mesh.vertices[t[0]];
        areas.push_back((mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm());
    }
    std::discrete_distribution<std::size_t> triangle(areas.begin(), areas.end());
    std::uniform_real_distribution<double> share(0.0, 1.0);
    std::vector<Vector3d> points;
    for (int i = 0; i < num; ++i) {
        const auto& t = mesh.triangles[triangle(random)];
        const double r = std::sqrt(share(random));
        const double s = share(random);
        points.push_back((1.0 - r) * mesh.vertices[t[0]] + r * (1.0 - s) * mesh.vertices[t[1]] +
                         r * s * mesh.vertices[t[2]]);
    }
    return points;
}

// Mean and 95th percentile.
std::pair<double, double> distances_mm(const std::vector<Vector3d>& points,
                                       const SurfaceTree& surface) {
    std::vector<double> all;
    for (const Vector3d& p : points) all.push_back(kMillimetres * surface.distance_m(p));
    std::ranges::sort(all);
    const double sum = std::accumulate(all.begin(), all.end(), 0.0);
    return {sum / static_cast<double>(all.size()), all[all.size() * 95 / 100]};
}

}  // namespace

SolidError compare_solids(const TriangleMesh& truth,
                          const TriangleMesh& mesh,
                          const SolidErrorOptions& options) {
    const SurfaceTree true_tree(truth);
    const SurfaceTree tree(mesh);
    SolidError error;
    error.true_volume_l = kLitres * geometry::volume_m3(truth);
    error.volume_l = kLitres * geometry::volume_m3(mesh);
    std::mt19937_64 random(options.seed);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    geometry::Aabb box = true_tree.box();
    box.min = box.min.cwiseMin(tree.box().min);
    box.max = box.max.cwiseMax(tree.box().max);
    const double cell_l = kLitres * std::pow(options.cell_m, 3);
    for (double x = box.min.x(); x < box.max.x(); x += options.cell_m) {
        for (double y = box.min.y(); y < box.max.y(); y += options.cell_m) {
            for (double z = box.min.z(); z < box.max.z(); z += options.cell_m) {
                Vector3d p(x, y, z);
                for (int c = 0; c < 3; ++c) p[c] += options.cell_m * share(random);
                const bool is_true = true_tree.winding_number(p) > 0.5;
                const bool is_in = tree.winding_number(p) > 0.5;
                if (is_in && !is_true) error.excess_l += cell_l;
                if (is_true && !is_in) error.missing_l += cell_l;
            }
        }
    }
    std::tie(error.mean_mm, error.p95_mm) =
        distances_mm(points_on(mesh, options.num_points, random), true_tree);
    std::tie(error.true_mean_mm, error.true_p95_mm) =
        distances_mm(points_on(truth, options.num_points, random), tree);
    return error;
}

}  // namespace atrium::test
