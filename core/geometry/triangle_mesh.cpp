#include "core/geometry/triangle_mesh.hpp"

#include "core/geometry/closed_mesh.hpp"
#include "core/geometry/edge_groups.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace atrium::geometry {
namespace {

std::uint32_t find_root(std::vector<std::uint32_t>& parent, std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

}  // namespace

MeshReport inspect(const TriangleMesh& mesh) {
    MeshReport report;
    report.volume_m3 = volume_m3(mesh);
    EdgeGroups groups;
    if (mesh.empty() || !groups.assign(mesh)) return report;
    const auto num_triangles = static_cast<std::uint32_t>(mesh.triangles.size());
    std::vector<std::uint32_t> parent(num_triangles);
    std::iota(parent.begin(), parent.end(), 0u);
    report.closed = true;
    std::int64_t num_edges = 0;
    groups.for_each([&](std::uint32_t, std::span<const EdgeGroups::Entry> group) {
        const std::uint32_t first = group[0].edge / 3;
        for (const EdgeGroups::Entry& entry : group)
            parent[find_root(parent, entry.edge / 3)] = find_root(parent, first);
        if (!EdgeGroups::is_pair(group)) report.closed = false;
        ++num_edges;
        return true;
    });
    for (std::uint32_t t = 0; t < num_triangles; ++t)
        report.num_components += find_root(parent, t) == t;
    report.manifold = report.closed && ClosedMesh().assign(mesh).has_value();
    report.euler_characteristic = static_cast<std::int64_t>(mesh.vertices.size()) - num_edges +
                                  static_cast<std::int64_t>(num_triangles);
    return report;
}

double volume_m3(const TriangleMesh& mesh) {
    if (mesh.vertices.empty()) return 0.0;
    // relative to a vertex: less cancellation than from the origin
    const Eigen::Vector3d origin = mesh.vertices.front();
    double six_volumes = 0.0;
    for (const auto& [a, b, c] : mesh.triangles) {
        if (std::max({a, b, c}) >= mesh.vertices.size()) continue;
        six_volumes += (mesh.vertices[a] - origin)
                           .dot((mesh.vertices[b] - origin).cross(mesh.vertices[c] - origin));
    }
    return six_volumes / 6.0;
}

void append(TriangleMesh& mesh, const TriangleMesh& part) {
    const auto offset = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
    for (const auto& [a, b, c] : part.triangles)
        mesh.triangles.push_back({a + offset, b + offset, c + offset});
}

Aabb bounds(const TriangleMesh& mesh) {
    Aabb box;
    for (const Eigen::Vector3d& p : mesh.vertices) box.add(p);
    return box;
}

std::vector<Eigen::Vector3f> vertex_normals(const TriangleMesh& mesh) {
    const Aabb box = bounds(mesh);
    const double largest_m = std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff());
    // a few thousand ulps of a position: hull vertices result from long computations
    const double min_height_m = 4096.0 * std::numeric_limits<double>::epsilon() * largest_m;
    std::vector<Eigen::Vector3d> sums(mesh.vertices.size(), Eigen::Vector3d::Zero());
    for (const auto& triangle : mesh.triangles) {
        std::array<Eigen::Vector3d, 3> sides;  // side k is opposite to corner k
        double longest_sq = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
            sides[k] = mesh.vertices[triangle[(k + 2) % 3]] - mesh.vertices[triangle[(k + 1) % 3]];
            longest_sq = std::max(longest_sq, sides[k].squaredNorm());
        }
        const Eigen::Vector3d normal = sides[0].cross(sides[1]);
        const double twice_area = normal.norm();
        if (!(twice_area > min_height_m * std::sqrt(longest_sq))) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const double angle =
                std::atan2(twice_area, -sides[(k + 1) % 3].dot(sides[(k + 2) % 3]));
            sums[triangle[k]] += (angle / twice_area) * normal;
        }
    }
    std::vector<Eigen::Vector3f> normals(sums.size());
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const double length = sums[i].norm();
        normals[i] = length > 0.0 ? Eigen::Vector3f((sums[i] / length).cast<float>())
                                  : Eigen::Vector3f::Zero();
    }
    return normals;
}

}  // namespace atrium::geometry
