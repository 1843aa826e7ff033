#include "core/geometry/surface_tree.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace atrium::geometry {
namespace {

constexpr std::uint32_t kMaxInLeaf = 8;
constexpr double kFar = 3.0;  // radii away from where triangles act as a dipole

using Eigen::Vector3d;

Vector3d area_of(const std::array<Vector3d, 3>& t) {
    return 0.5 * (t[1] - t[0]).cross(t[2] - t[0]);
}

double solid_angle(const std::array<Vector3d, 3>& t, const Vector3d& p) {
    const Vector3d a = t[0] - p;
    const Vector3d b = t[1] - p;
    const Vector3d c = t[2] - p;
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    return 2.0 * std::atan2(a.dot(b.cross(c)),
                            la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

double squared_distance(const Aabb& box, const Vector3d& p) {
    return (p - p.cwiseMax(box.min).cwiseMin(box.max)).squaredNorm();
}

double squared_distance(const Vector3d& a, const Vector3d& b, const Vector3d& p) {
    const Vector3d along = b - a;
    const double length_sq = along.squaredNorm();
    const double share =
        length_sq > 0.0 ? std::clamp((p - a).dot(along) / length_sq, 0.0, 1.0) : 0.0;
    return (p - a - share * along).squaredNorm();
}

// The foot of the perpendicular if it is in the triangle, else the nearest place of its edges.
double squared_distance(const std::array<Vector3d, 3>& t, const Vector3d& p) {
    const Vector3d area = area_of(t);
    const double area_sq = area.squaredNorm();
    const auto is_left_of = [&](std::size_t from, std::size_t to) {
        return (t[to] - t[from]).cross(p - t[from]).dot(area) >= 0.0;
    };
    if (area_sq > 0.0 && is_left_of(0, 1) && is_left_of(1, 2) && is_left_of(2, 0)) {
        const double height = (p - t[0]).dot(area);
        return height * height / area_sq;
    }
    return std::min({squared_distance(t[0], t[1], p),
                     squared_distance(t[1], t[2], p),
                     squared_distance(t[2], t[0], p)});
}

}  // namespace

SurfaceTree::SurfaceTree(const TriangleMesh& mesh) {
    triangles_.reserve(mesh.triangles.size());
    for (const auto& [a, b, c] : mesh.triangles)
        triangles_.push_back({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]});
    if (!empty()) add_node(0, static_cast<std::uint32_t>(triangles_.size()));
}

std::uint32_t SurfaceTree::add_node(std::uint32_t begin, std::uint32_t end) {
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    Node node;
    node.begin = begin;
    node.end = end;
    double sum_m2 = 0.0;
    for (std::uint32_t i = begin; i < end; ++i) {
        const Corners& t = triangles_[i];
        for (const Vector3d& corner : t) node.box.add(corner);
        const Vector3d area = area_of(t);
        const double area_m2 = area.norm();
        node.area += area;
        node.centre += area_m2 / 3.0 * (t[0] + t[1] + t[2]);
        sum_m2 += area_m2;
    }
    node.centre = sum_m2 > 0.0 ? Vector3d(node.centre / sum_m2) : node.box.centre();
    for (std::uint32_t i = begin; i < end; ++i) {
        for (const Vector3d& corner : triangles_[i])
            node.radius_m = std::max(node.radius_m, (corner - node.centre).norm());
    }
    nodes_.push_back(node);
    if (end - begin <= kMaxInLeaf) return index;
    Eigen::Index axis = 0;
    node.box.size().maxCoeff(&axis);
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(triangles_.begin() + begin,
                     triangles_.begin() + middle,
                     triangles_.begin() + end,
                     [axis](const Corners& l, const Corners& r) {
                         return l[0][axis] + l[1][axis] + l[2][axis] <
                                r[0][axis] + r[1][axis] + r[2][axis];
                     });
    add_node(begin, middle);
    const std::uint32_t second = add_node(middle, end);
    nodes_[index].second = second;
    return index;
}

double SurfaceTree::winding_number(const Vector3d& p) const {
    return empty() ? 0.0 : solid_angle_of(0, p) / (4.0 * std::numbers::pi);
}

double SurfaceTree::solid_angle_of(std::uint32_t node_index, const Vector3d& p) const {
    const Node& node = nodes_[node_index];
    const Vector3d to_centre = node.centre - p;
    const double away_m = to_centre.norm();
    if (away_m > kFar * node.radius_m) return node.area.dot(to_centre) / (away_m * away_m * away_m);
    if (node.second != 0) return solid_angle_of(node_index + 1, p) + solid_angle_of(node.second, p);
    double sum = 0.0;
    for (std::uint32_t i = node.begin; i < node.end; ++i) sum += solid_angle(triangles_[i], p);
    return sum;
}

double SurfaceTree::distance_m(const Vector3d& p) const {
    double nearest_sq = std::numeric_limits<double>::infinity();
    if (!empty()) find_nearest(0, p, nearest_sq);
    return std::sqrt(nearest_sq);
}

void SurfaceTree::find_nearest(std::uint32_t node_index,
                               const Vector3d& p,
                               double& nearest_sq) const {
    const Node& node = nodes_[node_index];
    if (squared_distance(node.box, p) >= nearest_sq) return;
    if (node.second == 0) {
        for (std::uint32_t i = node.begin; i < node.end; ++i)
            nearest_sq = std::min(nearest_sq, squared_distance(triangles_[i], p));
        return;
    }
    std::uint32_t near = node_index + 1;
    std::uint32_t far = node.second;
    if (squared_distance(nodes_[far].box, p) < squared_distance(nodes_[near].box, p))
        std::swap(near, far);
    find_nearest(near, p, nearest_sq);
    find_nearest(far, p, nearest_sq);
}

double SurfaceTree::depth_m(const Vector3d& p) const {
    if (!box().contains(p) || winding_number(p) <= 0.5) return 0.0;
    return distance_m(p);
}

}  // namespace atrium::geometry
