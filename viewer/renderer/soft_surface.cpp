#include "viewer/renderer/soft_surface.hpp"

#include <Eigen/Geometry>

#include <cassert>
#include <cmath>
#include <numbers>

namespace atrium::renderer {
namespace {

constexpr std::uint32_t kTubeSides = 6;

void add_triangles(const SoftLook& look, std::span<const Eigen::Vector3f> nodes, ShapeMesh& out) {
    if (look.triangles.empty()) return;
    for (const Eigen::Vector3f& node : nodes) out.corners.push_back({node, {0, 0, 0}});
    for (const auto& [a, b, c] : look.triangles) {
        // as long as twice the area: larger triangles count for more
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
        const float angle = 2.0F * std::numbers::pi_v<float> * static_cast<float>(i) / kTubeSides;
        const Eigen::Vector3f out_of = std::cos(angle) * u + std::sin(angle) * v;
        out.corners.push_back({from + radius * out_of, out_of});
        out.corners.push_back({to + radius * out_of, out_of});
        const std::uint32_t a = first + 2 * i;
        const std::uint32_t b = first + 2 * ((i + 1) % kTubeSides);
        for (const std::uint32_t index : {a, b, b + 1, a, b + 1, a + 1}) {
            out.indices.push_back(index);
        }
    }
}

}  // namespace

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
