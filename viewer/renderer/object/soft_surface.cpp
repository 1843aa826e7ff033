#include "viewer/renderer/object/soft_surface.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace atrium::renderer {
namespace {

constexpr std::uint32_t kTubeSides = 6;

void add_triangles(const SoftLook& look, std::span<const Eigen::Vector3f> nodes, ShapeMesh& out) {
    if (look.triangles.empty()) return;
    for (const Eigen::Vector3f& node : nodes) out.corners.push_back({node, {0, 0, 0}});
    if (look.texture_places.size() == nodes.size()) {
        for (std::size_t i = 0; i < nodes.size(); ++i)
            out.corners[i].texture_place = look.texture_places[i];
    }
    for (const auto& [a, b, c] : look.triangles) {
        // length is twice the area, which weights larger triangles more
        const Eigen::Vector3f normal = (nodes[b] - nodes[a]).cross(nodes[c] - nodes[a]);
        for (const std::uint32_t node : {a, b, c}) {
            out.corners[node].normal_object += normal;
            out.indices.push_back(node);
        }
    }
    for (auto& corner : out.corners) {
        const float length = corner.normal_object.norm();
        corner.normal_object = length > 0.0F ? Eigen::Vector3f(corner.normal_object / length)
                                             : Eigen::Vector3f::UnitZ();
    }
}

void add_tube(const Eigen::Vector3f& from,
              const Eigen::Vector3f& to,
              float radius,
              ShapeMesh& out) {
    const Eigen::Vector3f along = to - from;
    if (!(along.norm() > 1e-6F)) return;
    const Eigen::Vector3f u = along.unitOrthogonal();
    const Eigen::Vector3f v = along.normalized().cross(u);
    const auto first = static_cast<std::uint32_t>(out.corners.size());
    for (std::uint32_t i = 0; i < kTubeSides; ++i) {
        const float turn = static_cast<float>(i) / kTubeSides;
        const float angle = 2.0F * std::numbers::pi_v<float> * turn;
        const Eigen::Vector3f out_of = std::cos(angle) * u + std::sin(angle) * v;
        out.corners.push_back({from + radius * out_of, out_of, {turn, 0.0F}});
        out.corners.push_back({to + radius * out_of, out_of, {turn, 1.0F}});
        const std::uint32_t a = first + 2 * i;
        const std::uint32_t b = first + 2 * ((i + 1) % kTubeSides);
        for (const std::uint32_t index : {a, b, b + 1, a, b + 1, a + 1}) {
            out.indices.push_back(index);
        }
    }
}

// Number of nodes in a row of a cloth. 0 if the triangles do not form one.
std::uint32_t nodes_per_row(const SoftLook& look) {
    // the smallest neighbour of node 0 other than 1 begins the second row
    std::uint32_t columns = look.num_nodes;
    for (const auto& triangle : look.triangles) {
        if (std::find(triangle.begin(), triangle.end(), 0) == triangle.end()) continue;
        for (const std::uint32_t node : triangle) {
            if (node > 1) columns = std::min(columns, node);
        }
    }
    if (columns < 2 || look.num_nodes % columns != 0) return 0;
    const std::uint32_t rows = look.num_nodes / columns;
    const bool is_grid = rows > 1 && look.triangles.size() == 2 * (columns - 1) * (rows - 1);
    return is_grid ? columns : 0;
}

}  // namespace

std::vector<Eigen::Vector2f> make_texture_places(const SoftLook& look,
                                                 std::span<const Eigen::Vector3f> nodes_world) {
    assert(nodes_world.size() == look.num_nodes);
    std::vector<Eigen::Vector2f> places;
    if (const std::uint32_t columns = nodes_per_row(look)) {
        const std::uint32_t rows = look.num_nodes / columns;
        for (std::uint32_t i = 0; i < look.num_nodes; ++i) {
            places.emplace_back(static_cast<float>(i % columns) / static_cast<float>(columns - 1),
                                static_cast<float>(i / columns) / static_cast<float>(rows - 1));
        }
        return places;
    }
    Eigen::Vector3f middle = Eigen::Vector3f::Zero();
    for (const Eigen::Vector3f& node : nodes_world) middle += node;
    if (!nodes_world.empty()) middle /= static_cast<float>(nodes_world.size());
    for (const Eigen::Vector3f& node : nodes_world) {
        const Eigen::Vector3f out = node - middle;
        const float turn = std::atan2(out.y(), out.x()) / (2.0F * std::numbers::pi_v<float>);
        const float elevation = std::atan2(out.z(), out.head<2>().norm());
        places.emplace_back(0.5F + turn, 0.5F - elevation / std::numbers::pi_v<float>);
    }
    return places;
}

void make_soft_surface(const SoftLook& look,
                       std::span<const Eigen::Vector3f> nodes_world,
                       ShapeMesh& out) {
    assert(nodes_world.size() == look.num_nodes);
    out.corners.clear();
    out.indices.clear();
    add_triangles(look, nodes_world, out);
    const auto radius = static_cast<float>(0.5 * look.thickness_m);
    for (const auto& [a, b] : look.segments) add_tube(nodes_world[a], nodes_world[b], radius, out);
}

}  // namespace atrium::renderer
