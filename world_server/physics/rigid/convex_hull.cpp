#include "world_server/physics/rigid/convex_hull.hpp"

#include <Eigen/Geometry>
#include <LinearMath/btConvexHullComputer.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

namespace atrium::physics {
namespace {

constexpr double kMinVolumeM3 = 1e-9;

// Computes the full hull without a limit on its vertices.
geometry::TriangleMesh full_hull(const std::vector<Eigen::Vector3d>& points) {
    geometry::TriangleMesh hull;
    if (points.size() < 4) return hull;
    btConvexHullComputer computer;
    computer.compute(points.front().data(),
                     static_cast<int>(sizeof(Eigen::Vector3d)),
                     static_cast<int>(points.size()),
                     btScalar(0),
                     btScalar(0));
    for (int v = 0; v < computer.vertices.size(); ++v) {
        hull.vertices.push_back(
            points.at(static_cast<std::size_t>(computer.original_vertex_index[v])));
    }
    for (int f = 0; f < computer.faces.size(); ++f) {
        // triangulate the face as a fan around its first corner
        const btConvexHullComputer::Edge* first = &computer.edges[computer.faces[f]];
        const auto corner = static_cast<std::uint32_t>(first->getSourceVertex());
        const btConvexHullComputer::Edge* edge = first->getNextEdgeOfFace();
        for (; edge->getTargetVertex() != first->getSourceVertex();
             edge = edge->getNextEdgeOfFace()) {
            hull.triangles.push_back({corner,
                                      static_cast<std::uint32_t>(edge->getSourceVertex()),
                                      static_cast<std::uint32_t>(edge->getTargetVertex())});
        }
    }
    double volume = geometry::volume_m3(hull);
    if (volume < 0.0) {
        for (auto& triangle : hull.triangles) std::swap(triangle[1], triangle[2]);
        volume = -volume;
    }
    if (!(volume > kMinVolumeM3)) hull.clear();
    return hull;
}

// Unit vectors along a spiral from pole to pole.
Eigen::Vector3d spread_direction(std::size_t index, std::size_t num) {
    const double z = 1.0 - 2.0 * (static_cast<double>(index) + 0.5) / static_cast<double>(num);
    const double turn =
        std::numbers::pi * (3.0 - std::sqrt(5.0)) * static_cast<double>(index);  // golden angle
    const double radius = std::sqrt(1.0 - z * z);
    return {radius * std::cos(turn), radius * std::sin(turn), z};
}

// Both directions of each axis first: the hull keeps its extents and the height at which it rests.
Eigen::Vector3d cut_direction(std::size_t index, std::size_t num) {
    constexpr std::size_t kAlongAxes = 6;
    if (index >= kAlongAxes) return spread_direction(index - kAlongAxes, num - kAlongAxes);
    const auto axis = static_cast<Eigen::Index>(index / 2);
    return (index % 2 == 0 ? 1.0 : -1.0) * Eigen::Vector3d::Unit(axis);
}

std::vector<Eigen::Vector3d> furthest_out(const std::vector<Eigen::Vector3d>& points,
                                          std::size_t num_directions) {
    std::set<std::size_t> kept;
    for (std::size_t d = 0; d < num_directions; ++d) {
        const Eigen::Vector3d direction = cut_direction(d, num_directions);
        std::size_t best = 0;
        for (std::size_t i = 1; i < points.size(); ++i) {
            if (direction.dot(points[i]) > direction.dot(points[best])) best = i;
        }
        kept.insert(best);
    }
    std::vector<Eigen::Vector3d> few;
    for (const std::size_t i : kept) few.push_back(points[i]);
    return few;
}

}  // namespace

geometry::TriangleMesh convex_hull(const std::vector<Eigen::Vector3d>& points,
                                   std::size_t max_vertices) {
    assert(max_vertices >= 8);
    geometry::TriangleMesh hull = full_hull(points);
    if (hull.vertices.size() > max_vertices)
        hull = full_hull(furthest_out(hull.vertices, max_vertices));
    return hull;
}

MassProperties mass_properties(const std::vector<geometry::TriangleMesh>& parts) {
    MassProperties sum;
    Eigen::Vector3d first_moment = Eigen::Vector3d::Zero();
    Eigen::Matrix3d second_moment = Eigen::Matrix3d::Zero();  // integral of x x^T about the origin
    for (const geometry::TriangleMesh& part : parts) {
        for (const auto& triangle : part.triangles) {
            const Eigen::Vector3d& a = part.vertices[triangle[0]];
            const Eigen::Vector3d& b = part.vertices[triangle[1]];
            const Eigen::Vector3d& c = part.vertices[triangle[2]];
            const double volume = a.dot(b.cross(c)) / 6.0;
            const Eigen::Vector3d all = a + b + c;
            sum.volume_m3 += volume;
            first_moment += volume / 4.0 * all;
            second_moment +=
                volume / 20.0 *
                (all * all.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
        }
    }
    if (!(sum.volume_m3 > 0.0)) return sum;
    sum.centre = first_moment / sum.volume_m3;
    const Eigen::Matrix3d about_centre =
        second_moment - sum.volume_m3 * sum.centre * sum.centre.transpose();
    sum.inertia = about_centre.trace() * Eigen::Matrix3d::Identity() - about_centre;
    return sum;
}

}  // namespace atrium::physics
