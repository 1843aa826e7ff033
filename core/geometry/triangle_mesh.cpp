#include "core/geometry/triangle_mesh.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace atrium::geometry {
namespace {

struct HalfEdge {
    std::uint64_t key = 0;  // smaller vertex index in the high half
    std::uint32_t triangle = 0;
    bool forward = false;  // from the smaller to the larger index
};

std::vector<HalfEdge> sorted_half_edges(const TriangleMesh& mesh) {
    std::vector<HalfEdge> edges;
    edges.reserve(mesh.triangles.size() * 3);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t a = mesh.triangles[t][static_cast<std::size_t>(k)];
            const std::uint32_t b = mesh.triangles[t][static_cast<std::size_t>((k + 1) % 3)];
            const std::uint64_t key =
                (static_cast<std::uint64_t>(std::min(a, b)) << 32) | std::max(a, b);
            edges.push_back({key, t, a < b});
        }
    }
    std::sort(edges.begin(), edges.end(), [](const HalfEdge& l, const HalfEdge& r) {
        return l.key != r.key ? l.key < r.key : l.triangle < r.triangle;
    });
    return edges;
}

std::uint32_t find_root(std::vector<std::uint32_t>& parent, std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

// Closed surface: the triangles at a vertex form one fan exactly if walking from one of them over
// shared edges meets as many triangles as the vertex has.
bool every_vertex_is_one_fan(const TriangleMesh& mesh) {
    std::vector<std::uint32_t> num_corners(mesh.vertices.size(), 0);
    for (const auto& t : mesh.triangles) {
        for (const std::uint32_t v : t) ++num_corners[v];
    }
    // successor of the edge (v -> a) around v is (v -> c) in the triangle (v, a, c)
    struct Spoke {
        std::uint32_t centre, from, to;
        bool operator<(const Spoke& o) const {
            return centre != o.centre ? centre < o.centre : from < o.from;
        }
    };
    std::vector<Spoke> spokes;
    spokes.reserve(mesh.triangles.size() * 3);
    for (const auto& [a, b, c] : mesh.triangles) {
        spokes.push_back({a, b, c});
        spokes.push_back({b, c, a});
        spokes.push_back({c, a, b});
    }
    std::sort(spokes.begin(), spokes.end());
    std::size_t begin = 0;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
        const std::size_t count = num_corners[v];
        if (count == 0) return false;  // an unused vertex
        std::uint32_t at = spokes[begin].from;
        std::size_t steps = 0;
        do {
            const auto first = spokes.begin() + static_cast<std::ptrdiff_t>(begin);
            const auto last = first + static_cast<std::ptrdiff_t>(count);
            const auto it = std::lower_bound(first, last, Spoke{v, at, 0});
            if (it == last || it->from != at) return false;
            at = it->to;
            ++steps;
        } while (at != spokes[begin].from && steps <= count);
        if (steps != count) return false;
        begin += count;
    }
    return true;
}

}  // namespace

MeshReport inspect(const TriangleMesh& mesh) {
    MeshReport report;
    report.volume_m3 = volume_m3(mesh);
    const auto num_triangles = static_cast<std::uint32_t>(mesh.triangles.size());
    if (num_triangles == 0) return report;
    const bool indices_valid =
        std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& t) {
            return std::all_of(
                       t.begin(), t.end(), [&](auto v) { return v < mesh.vertices.size(); }) &&
                   t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
        });
    if (!indices_valid) return report;

    const std::vector<HalfEdge> edges = sorted_half_edges(mesh);
    std::vector<std::uint32_t> parent(num_triangles);
    std::iota(parent.begin(), parent.end(), 0u);
    report.closed = true;
    std::int64_t num_edges = 0;
    for (std::size_t i = 0; i < edges.size();) {
        std::size_t end = i;
        int balance = 0;
        while (end < edges.size() && edges[end].key == edges[i].key) {
            balance += edges[end].forward ? 1 : -1;
            parent[find_root(parent, edges[end].triangle)] = find_root(parent, edges[i].triangle);
            ++end;
        }
        if (end - i != 2 || balance != 0) report.closed = false;
        ++num_edges;
        i = end;
    }
    for (std::uint32_t t = 0; t < num_triangles; ++t)
        report.num_components += find_root(parent, t) == t;
    report.manifold = report.closed && every_vertex_is_one_fan(mesh);
    report.euler_characteristic = static_cast<std::int64_t>(mesh.vertices.size()) - num_edges +
                                  static_cast<std::int64_t>(num_triangles);
    return report;
}

double volume_m3(const TriangleMesh& mesh) {
    if (mesh.vertices.empty()) return 0.0;
    // relative to a vertex near the surface: less cancellation than from the origin
    const Eigen::Vector3d origin = mesh.vertices.front();
    double six_volumes = 0.0;
    for (const auto& [a, b, c] : mesh.triangles) {
        if (std::max({a, b, c}) >= mesh.vertices.size()) continue;
        six_volumes += (mesh.vertices[a] - origin)
                           .dot((mesh.vertices[b] - origin).cross(mesh.vertices[c] - origin));
    }
    return six_volumes / 6.0;
}

Aabb bounds(const TriangleMesh& mesh) {
    Aabb box;
    for (const Eigen::Vector3d& p : mesh.vertices) box.add(p);
    return box;
}

std::vector<Eigen::Vector3f> vertex_normals(const TriangleMesh& mesh) {
    const Aabb box = bounds(mesh);
    const double largest_m = std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff());
    // a few thousand roundings of a position: hull vertices come from long computations
    const double min_height_m = 4096.0 * std::numeric_limits<double>::epsilon() * largest_m;
    std::vector<Eigen::Vector3d> sums(mesh.vertices.size(), Eigen::Vector3d::Zero());
    for (const auto& triangle : mesh.triangles) {
        std::array<Eigen::Vector3d, 3> sides;  // each opposite to the corner with its number
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

double winding_number(const TriangleMesh& mesh, const Eigen::Vector3d& p) {
    double solid_angle = 0.0;
    for (const auto& [ia, ib, ic] : mesh.triangles) {
        const Eigen::Vector3d a = mesh.vertices[ia] - p;
        const Eigen::Vector3d b = mesh.vertices[ib] - p;
        const Eigen::Vector3d c = mesh.vertices[ic] - p;
        const double la = a.norm();
        const double lb = b.norm();
        const double lc = c.norm();
        const double numerator = a.dot(b.cross(c));
        const double denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        solid_angle += 2.0 * std::atan2(numerator, denominator);
    }
    return solid_angle / (4.0 * std::numbers::pi);
}

}  // namespace atrium::geometry
