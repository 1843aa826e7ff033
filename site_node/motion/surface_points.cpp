#include "site_node/motion/surface_points.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace atrium::motion {
namespace {

// Low-discrepancy points of the unit square (R2 sequence), folded into the triangle.
Eigen::Vector2d place_in_triangle(std::size_t index) {
    const auto n = static_cast<double>(index + 1);
    double u = n * 0.7548776662466927;
    double v = n * 0.5698402909980532;
    u -= std::floor(u);
    v -= std::floor(v);
    return u + v > 1.0 ? Eigen::Vector2d(1.0 - u, 1.0 - v) : Eigen::Vector2d(u, v);
}

}  // namespace

void SurfacePoints::assign(const geometry::TriangleMesh& mesh_site,
                           double sample_m,
                           double cell_m) {
    const auto edges_of = [&](const std::array<std::uint32_t, 3>& t) {
        const Eigen::Vector3d& a = mesh_site.vertices[t[0]];
        return std::pair<Eigen::Vector3d, Eigen::Vector3d>(mesh_site.vertices[t[1]] - a,
                                                           mesh_site.vertices[t[2]] - a);
    };
    double area_m2 = 0.0;
    for (const auto& triangle : mesh_site.triangles) {
        const auto [u, v] = edges_of(triangle);
        area_m2 += 0.5 * u.cross(v).norm();
    }
    const double per_point_m2 =
        std::max(sample_m * sample_m, area_m2 / static_cast<double>(kMaxPoints));
    placed_.clear();
    double carried_m2 = 0.5 * per_point_m2;
    for (const auto& triangle : mesh_site.triangles) {
        const auto [u, v] = edges_of(triangle);
        const Eigen::Vector3d across = u.cross(v);
        const double doubled_m2 = across.norm();
        carried_m2 += 0.5 * doubled_m2;
        for (; carried_m2 > per_point_m2; carried_m2 -= per_point_m2) {
            const Eigen::Vector2d at = place_in_triangle(placed_.size());
            const Eigen::Vector3d position =
                mesh_site.vertices[triangle[0]] + at.x() * u + at.y() * v;
            const auto cell_of = [&](double x) {
                return static_cast<std::int32_t>(std::floor(x / cell_m));
            };
            placed_.push_back(
                {{cell_of(position.z()), cell_of(position.y()), cell_of(position.x())},
                 {position, across / doubled_m2}});
        }
    }
    std::ranges::stable_sort(placed_, {}, &Placed::cell);
    points.clear();
    first_of_cell.clear();
    centres.clear();
    for (std::size_t i = 0; i < placed_.size(); ++i) {
        if (i == 0 || placed_[i].cell != placed_[i - 1].cell) {
            first_of_cell.push_back(static_cast<std::uint32_t>(i));
            centres.emplace_back(Eigen::Vector3d::Zero());
        }
        points.push_back(placed_[i].point);
        centres.back() += placed_[i].point.position;
    }
    first_of_cell.push_back(static_cast<std::uint32_t>(placed_.size()));
    for (std::size_t c = 0; c < centres.size(); ++c)
        centres[c] /= static_cast<double>(first_of_cell[c + 1] - first_of_cell[c]);
}

}  // namespace atrium::motion
