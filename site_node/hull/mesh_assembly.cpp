#include "site_node/hull/mesh_assembly.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>

namespace atrium::hull {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

}  // namespace

std::uint32_t MeshAssembly::index_of(VertexKey key) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = static_cast<std::size_t>((key * 0x9e3779b97f4a7c15ULL) >> 20) & mask;
    while (slots_[at].key != 0 && slots_[at].key != key) at = (at + 1) & mask;
    if (slots_[at].key == 0) {
        slots_[at] = {key, static_cast<std::uint32_t>(keys_.size())};
        keys_.push_back(key);
        positions_.emplace_back(Eigen::Vector3d::Zero());
        is_placed_.push_back(0);
        on_viewing_edge_.push_back(0);
    }
    return slots_[at].index;
}

bool MeshAssembly::join(const Cones&, std::span<const RunFaces> runs) {
    std::size_t num_corners = 0;
    for (const RunFaces& run : runs) num_corners += run.vertices.size();
    // each vertex of a sound mesh comes three times
    slots_.assign(std::bit_ceil(num_corners + 16), Slot{});
    keys_.clear();
    positions_.clear();
    is_placed_.clear();
    on_viewing_edge_.clear();
    global_.clear();
    run_begin_.clear();
    for (const RunFaces& run : runs) {
        run_begin_.push_back(static_cast<std::uint32_t>(global_.size()));
        for (const RunFaces::Vertex& vertex : run.vertices) {
            const std::uint32_t v = index_of(vertex.key);
            global_.push_back(v);
            on_viewing_edge_[v] |= static_cast<std::uint8_t>(vertex.on_viewing_edge);
            if (!vertex.is_owner) continue;
            positions_[v] = vertex.position;
            is_placed_[v] = 1;
        }
    }
    return std::all_of(
        is_placed_.begin(), is_placed_.end(), [](std::uint8_t placed) { return placed != 0; });
}

bool MeshAssembly::verify(const Cones& cones, std::span<const RunFaces> runs) {
    corners_.assign(keys_.size(), Corners{});
    std::size_t num_edges = 0;
    std::size_t num_along_edges = 0;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        const std::uint32_t* global = global_.data() + run_begin_[r];
        for (const auto& [from, to] : runs[r].edges) {
            const std::uint32_t a = global[from];
            const std::uint32_t b = global[to];
            const bool a_is_centre = (keys_[a] & kCentreBit) != 0;
            const bool b_is_centre = (keys_[b] & kCentreBit) != 0;
            if (!a_is_centre) {
                if (corners_[a].num_out == 3) return cones.min_seen > 0;
                corners_[a].out[corners_[a].num_out++] = b;
            }
            if (!b_is_centre) {
                if (corners_[b].num_in == 3) return cones.min_seen > 0;
                corners_[b].in[corners_[b].num_in++] = a;
            }
        }
        num_edges += runs[r].edges.size();
        num_along_edges += runs[r].num_sides_on_lines;
    }
    // any other side on a line would be the diagonal of two faces
    if (num_along_edges != num_edges) return cones.min_seen > 0;
    for (std::size_t v = 0; v < keys_.size(); ++v) {
        if ((keys_[v] & kCentreBit) != 0) continue;
        Corners& c = corners_[v];
        if (c.num_in != 3 || c.num_out != 3) return false;
        std::sort(c.in.begin(), c.in.end());
        std::sort(c.out.begin(), c.out.end());
        if (c.in != c.out || c.in[0] == c.in[1] || c.in[1] == c.in[2]) return false;
    }
    return true;
}

bool MeshAssembly::is_manifold(const geometry::TriangleMesh& mesh) {
    const auto ends = [](std::uint64_t from, std::uint64_t to) { return (from << 32) | to; };
    const auto by_ends = [](const HalfEdge& l, const HalfEdge& r) { return l.ends < r.ends; };
    half_edges_.clear();
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        half_edges_.push_back({ends(a, b), 3 * t});
        half_edges_.push_back({ends(b, c), 3 * t + 1});
        half_edges_.push_back({ends(c, a), 3 * t + 2});
    }
    std::sort(half_edges_.begin(), half_edges_.end(), by_ends);
    // corners at one vertex are one cycle if shared edges lead to all of them
    parent_.resize(half_edges_.size());
    for (std::uint32_t corner = 0; corner < parent_.size(); ++corner) parent_[corner] = corner;
    std::size_t num_cycles = parent_.size();
    const auto next = [](std::uint32_t corner) {
        return corner % 3 == 2 ? corner - 2 : corner + 1;
    };
    for (std::size_t e = 0; e < half_edges_.size(); ++e) {
        const HalfEdge& edge = half_edges_[e];
        if (e > 0 && half_edges_[e - 1].ends == edge.ends) return false;
        const HalfEdge wanted{ends(edge.ends & 0xffffffffu, edge.ends >> 32), 0};
        const auto twin = std::lower_bound(half_edges_.begin(), half_edges_.end(), wanted, by_ends);
        if (twin == half_edges_.end() || twin->ends != wanted.ends) return false;
        const std::uint32_t here = find_root(edge.corner);
        const std::uint32_t there = find_root(next(twin->corner));
        if (here == there) continue;
        unite(here, there);
        --num_cycles;
    }
    return num_cycles == mesh.vertices.size();
}

std::uint32_t MeshAssembly::find_root(std::uint32_t v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
}

void MeshAssembly::unite(std::uint32_t a, std::uint32_t b) {
    a = find_root(a);
    b = find_root(b);
    parent_[std::max(a, b)] = std::min(a, b);
}

void MeshAssembly::measure_components(std::span<const RunFaces> runs) {
    parent_.resize(keys_.size());
    for (std::uint32_t v = 0; v < parent_.size(); ++v) parent_[v] = v;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        const std::uint32_t* global = global_.data() + run_begin_[r];
        for (const auto& [a, b, c] : runs[r].triangles) {
            unite(global[a], global[b]);
            unite(global[b], global[c]);
        }
    }
    components_.assign(keys_.size(), Component{});
    for (std::size_t r = 0; r < runs.size(); ++r) {
        const std::uint32_t* global = global_.data() + run_begin_[r];
        for (const auto& [a, b, c] : runs[r].triangles) {
            const std::uint32_t root = find_root(global[a]);
            const Eigen::Vector3d& from = positions_[root];  // near by: less cancellation
            components_[root].six_volumes +=
                (positions_[global[a]] - from)
                    .dot((positions_[global[b]] - from).cross(positions_[global[c]] - from));
        }
    }
    for (std::uint32_t v = 0; v < keys_.size(); ++v) {
        if (on_viewing_edge_[v] != 0) components_[find_root(v)].has_viewing_edge = true;
    }
}

void MeshAssembly::choose_components(const HullOptions& options, VisualHull& hull) {
    for (std::uint32_t v = 0; v < keys_.size(); ++v) {
        if (parent_[v] != v) continue;
        Component& component = components_[v];
        const bool is_fragment = component.six_volumes < 6.0 * options.min_component_volume_m3;
        component.is_kept = options.keep_phantoms || (component.has_viewing_edge && !is_fragment);
        if (component.is_kept) {
            ++hull.num_components;
        } else if (!component.has_viewing_edge) {
            ++hull.num_phantoms_dropped;
        } else {
            ++hull.num_fragments_dropped;
        }
    }
}

void MeshAssembly::extract(const Cones& cones,
                           std::span<const RunFaces> runs,
                           const HullOptions& options,
                           VisualHull& hull) {
    hull.mesh.clear();
    hull.num_components = hull.num_phantoms_dropped = hull.num_fragments_dropped = 0;
    measure_components(runs);
    choose_components(options, hull);
    output_index_.assign(keys_.size(), kNone);
    for (std::uint32_t v = 0; v < keys_.size(); ++v) {
        if (!components_[find_root(v)].is_kept) continue;
        output_index_[v] = static_cast<std::uint32_t>(hull.mesh.vertices.size());
        hull.mesh.vertices.push_back(positions_[v] + cones.origin);
    }
    for (std::size_t r = 0; r < runs.size(); ++r) {
        const std::uint32_t* global = global_.data() + run_begin_[r];
        for (const auto& [a, b, c] : runs[r].triangles) {
            const std::uint32_t first = output_index_[global[a]];
            if (first == kNone) continue;
            hull.mesh.triangles.push_back(
                {first, output_index_[global[b]], output_index_[global[c]]});
        }
    }
}

}  // namespace atrium::hull
