#include "tests/support/shapes/surface_distance.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace atrium::test {
namespace {

using Eigen::Vector3d;

double distance_to_edge(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
    const Vector3d ab = b - a;
    const double length_sq = ab.squaredNorm();
    const double t = length_sq > 0.0 ? std::clamp((p - a).dot(ab) / length_sq, 0.0, 1.0) : 0.0;
    return (p - a - t * ab).norm();
}

// To the triangle's plane if the foot point is inside, otherwise to its nearest edge.
double distance_to_triangle(const Vector3d& p, const std::array<Vector3d, 3>& t) {
    const Vector3d normal = (t[1] - t[0]).cross(t[2] - t[0]);
    const double area_sq = normal.squaredNorm();
    if (area_sq > 0.0) {
        const double u = (t[1] - p).cross(t[2] - p).dot(normal) / area_sq;
        const double v = (t[2] - p).cross(t[0] - p).dot(normal) / area_sq;
        if (u >= 0.0 && v >= 0.0 && u + v <= 1.0)
            return std::abs((p - t[0]).dot(normal)) / std::sqrt(area_sq);
    }
    return std::min({distance_to_edge(p, t[0], t[1]),
                     distance_to_edge(p, t[1], t[2]),
                     distance_to_edge(p, t[2], t[0])});
}

std::array<Vector3d, 3> corners_of(const geometry::TriangleMesh& mesh, std::size_t triangle) {
    const auto& [a, b, c] = mesh.triangles[triangle];
    return {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
}

}  // namespace

SurfaceDistance::SurfaceDistance(const geometry::TriangleMesh& mesh) : mesh_(mesh) {
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const std::array<Vector3d, 3> t = corners_of(mesh, i);
        const Vector3d centre = (t[0] + t[1] + t[2]) / 3.0;
        double radius = 0.0;
        for (const Vector3d& p : t) radius = std::max(radius, (p - centre).norm());
        centres_.push_back(centre);
        radii_m_.push_back(radius * (1.0 + 1e-9));
    }
}

double SurfaceDistance::distance_m(const Vector3d& p) const {
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < centres_.size(); ++i) {
        const double reach = best + radii_m_[i];
        if ((p - centres_[i]).squaredNorm() >= reach * reach) continue;
        best = std::min(best, distance_to_triangle(p, corners_of(mesh_, i)));
    }
    return best;
}

double SurfaceDistance::largest_m(const geometry::TriangleMesh& from, int num_random) const {
    double largest = 0.0;
    const auto look = [&](const Vector3d& p) { largest = std::max(largest, distance_m(p)); };
    for (const Vector3d& p : from.vertices) look(p);
    std::vector<double> areas;
    for (std::size_t i = 0; i < from.triangles.size(); ++i) {
        const std::array<Vector3d, 3> t = corners_of(from, i);
        look((t[0] + t[1] + t[2]) / 3.0);
        for (std::size_t k = 0; k < 3; ++k) look(0.5 * (t[k] + t[(k + 1) % 3]));
        areas.push_back((t[1] - t[0]).cross(t[2] - t[0]).norm());
    }
    if (num_random == 0) return largest;
    std::mt19937_64 random(1);
    std::discrete_distribution<std::size_t> triangle(areas.begin(), areas.end());
    std::uniform_real_distribution<double> share(0.0, 1.0);
    for (int i = 0; i < num_random; ++i) {
        const std::array<Vector3d, 3> t = corners_of(from, triangle(random));
        const double r = std::sqrt(share(random));
        const double s = share(random);
        look((1.0 - r) * t[0] + r * (1.0 - s) * t[1] + r * s * t[2]);
    }
    return largest;
}

}  // namespace atrium::test
