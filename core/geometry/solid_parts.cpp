#include "core/geometry/solid_parts.hpp"

#include "core/geometry/edge_groups.hpp"
#include "core/geometry/weld.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <numeric>

namespace atrium::geometry {
namespace {

struct SolidPart {
    Aabb box;
    double six_volumes_m3 = 0.0;
    bool is_closed = true;
    bool is_kept = false;
};

// Signed share of the box that the part fills; both sides of a sheet fill nothing.
constexpr double kLeastFill = 1e-6;

bool faces(const SolidPart& part, double outwards) {
    return part.is_closed && !part.box.empty() &&
           outwards * part.six_volumes_m3 / 6.0 > kLeastFill * part.box.size().prod();
}

// Per triangle the number of its part: its first triangle. Parts are connected by edges.
std::vector<std::uint32_t> part_of_triangles(const TriangleMesh& mesh,
                                             const EdgeGroups& edges,
                                             std::vector<SolidPart>& parts) {
    std::vector<std::uint32_t> part_of(mesh.triangles.size());
    std::iota(part_of.begin(), part_of.end(), 0u);
    const auto root = [&part_of](std::uint32_t t) {
        while (part_of[t] != t) t = part_of[t] = part_of[part_of[t]];
        return t;
    };
    std::vector<std::uint32_t> at_a_hole;
    edges.for_each([&](std::uint32_t, std::span<const EdgeGroups::Entry> group) {
        std::int64_t balance = 0;
        for (const EdgeGroups::Entry& entry : group) {
            const auto [low, high] = std::minmax({root(group[0].edge / 3), root(entry.edge / 3)});
            part_of[high] = low;
            balance += entry.is_upwards ? 1 : -1;
        }
        if (balance != 0) at_a_hole.push_back(group[0].edge / 3);
        return true;
    });
    for (std::uint32_t t = 0; t < part_of.size(); ++t) part_of[t] = root(t);
    for (const std::uint32_t t : at_a_hole) parts[part_of[t]].is_closed = false;
    return part_of;
}

}  // namespace

TriangleMesh solid_parts(const TriangleMesh& mesh, double room_m) {
    TriangleMesh solid = weld(mesh);
    EdgeGroups edges;
    if (!edges.assign(solid)) return {};
    std::vector<SolidPart> parts(solid.triangles.size());  // at the number of the part
    const std::vector<std::uint32_t> part_of = part_of_triangles(solid, edges, parts);
    for (std::size_t t = 0; t < part_of.size(); ++t) {
        SolidPart& part = parts[part_of[t]];
        const auto& [a, b, c] = solid.triangles[t];
        for (const std::uint32_t v : {a, b, c}) part.box.add(solid.vertices[v]);
        // relative to a vertex of the part: less cancellation than from the origin
        const Eigen::Vector3d& origin = solid.vertices[solid.triangles[part_of[t]][0]];
        part.six_volumes_m3 +=
            (solid.vertices[a] - origin)
                .dot((solid.vertices[b] - origin).cross(solid.vertices[c] - origin));
    }
    std::vector<const SolidPart*> bodies;
    for (SolidPart& part : parts) {
        part.is_kept = faces(part, 1.0) && part.box.size().minCoeff() < room_m;
        if (part.is_kept) bodies.push_back(&part);
    }
    for (SolidPart& part : parts) {
        if (!faces(part, -1.0)) continue;
        part.is_kept = std::ranges::any_of(bodies, [&](const SolidPart* body) {
            return body->box.contains(part.box.min) && body->box.contains(part.box.max);
        });
    }
    std::vector<std::array<std::uint32_t, 3>> kept;
    for (std::size_t t = 0; t < part_of.size(); ++t)
        if (parts[part_of[t]].is_kept) kept.push_back(solid.triangles[t]);
    solid.triangles = std::move(kept);
    return solid;
}

}  // namespace atrium::geometry
