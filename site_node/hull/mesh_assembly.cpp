#include "site_node/hull/mesh_assembly.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>

namespace atrium::hull {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

void sort_three(std::array<std::uint32_t, 3>& list) {
    const auto [a, b, c] = list;
    const std::uint32_t least = std::min({a, b, c});
    const std::uint32_t greatest = std::max({a, b, c});
    list = {least, a ^ b ^ c ^ least ^ greatest, greatest};
}

void clear_result(VisualHull& hull) {
    hull.mesh.clear();
    hull.num_components = hull.num_phantoms_dropped = hull.num_fragments_dropped = 0;
    hull.volume_dropped_m3 = 0.0;
}

}  // namespace

bool MeshAssembly::assemble(const Cones& cones,
                            std::span<const RunFaces> runs,
                            const HullOptions& options,
                            Executor& executor,
                            VisualHull& hull) {
    clear_result(hull);
    if (!join(runs)) return false;
    bool is_sound = false;
    const auto finish = [&](std::size_t task, std::size_t) {  // two independent tasks
        if (task == 0) {
            extract(cones, options, hull);
        } else if (cones.min_seen > 0) {  // more than three faces may meet in a vertex
            is_sound = surface_.assign(joined_).has_value();
        } else {
            is_sound = has_three_faces_everywhere(runs);
        }
    };
    executor.parallel_for(2, finish);
    if (!is_sound) clear_result(hull);
    return is_sound;
}

// Returns the number of `key`; appends a new key to `keys_`.
std::uint32_t MeshAssembly::index_of(VertexKey key) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = slot_of(key);
    while (slots_[at].key != 0 && slots_[at].key != key) at = (at + 1) & mask;
    Slot& slot = slots_[at];
    if (slot.key == 0) {
        slot = {key, static_cast<std::uint32_t>(keys_.size())};
        keys_.push_back(key);
    }
    return slot.index;
}

bool MeshAssembly::join(std::span<const RunFaces> runs) {
    std::size_t num_corners = 0;
    std::size_t num_triangles = 0;
    for (const RunFaces& run : runs) {
        num_corners += run.vertices.size();
        num_triangles += run.triangles.size();
    }
    // a sound mesh names each vertex three times, so the table is at most a third full
    slots_.assign(std::bit_ceil(num_corners + 16), Slot{});
    keys_.clear();
    global_.resize(num_corners);
    run_begin_.clear();
    joined_.triangles.resize(num_triangles);
    std::uint32_t* global = global_.data();
    auto triangle = joined_.triangles.begin();
    for (const RunFaces& run : runs) {
        run_begin_.push_back(static_cast<std::uint32_t>(global - global_.data()));
        const std::size_t n = run.vertices.size();
        for (std::size_t i = 0; i < n; ++i) {
            constexpr std::size_t kAhead = 8;
            if (i + kAhead < n) __builtin_prefetch(&slots_[slot_of(run.vertices[i + kAhead].key)]);
            global[i] = index_of(run.vertices[i].key);
        }
        for (const auto& [a, b, c] : run.triangles) *triangle++ = {global[a], global[b], global[c]};
        global += run.vertices.size();
    }
    return place(runs);
}

// Takes the position of each vertex from its owner. False if a vertex has no owner.
bool MeshAssembly::place(std::span<const RunFaces> runs) {
    joined_.vertices.resize(keys_.size());
    is_placed_.assign(keys_.size(), 0);
    may_be_needed_.assign(keys_.size(), 0);
    const std::uint32_t* global = global_.data();
    for (const RunFaces& run : runs) {
        for (const RunFaces::Vertex& vertex : run.vertices) {
            const std::uint32_t v = *global++;
            may_be_needed_[v] |= static_cast<std::uint8_t>(vertex.may_be_needed);
            if (!vertex.is_owner) continue;
            joined_.vertices[v] = vertex.position;
            is_placed_[v] = 1;
        }
    }
    return std::find(is_placed_.begin(), is_placed_.end(), 0) == is_placed_.end();
}

bool MeshAssembly::has_three_faces_everywhere(std::span<const RunFaces> runs) {
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
                if (corners_[a].num_out == 3) return false;
                corners_[a].out[corners_[a].num_out++] = b;
            }
            if (!b_is_centre) {
                if (corners_[b].num_in == 3) return false;
                corners_[b].in[corners_[b].num_in++] = a;
            }
        }
        num_edges += runs[r].edges.size();
        num_along_edges += runs[r].num_sides_on_lines;
    }
    // any other side on a line would be a diagonal that two faces share
    if (num_along_edges != num_edges) return false;
    for (std::size_t v = 0; v < keys_.size(); ++v) {
        if ((keys_[v] & kCentreBit) != 0) continue;
        Corners& c = corners_[v];
        if (c.num_in != 3 || c.num_out != 3) return false;
        sort_three(c.in);
        sort_three(c.out);
        if (c.in != c.out || c.in[0] == c.in[1] || c.in[1] == c.in[2]) return false;
    }
    return true;
}

std::uint32_t MeshAssembly::find_root(std::uint32_t v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
}

void MeshAssembly::measure_components() {
    parent_.resize(keys_.size());
    std::uint32_t* const parent = parent_.data();
    for (std::uint32_t v = 0; v < parent_.size(); ++v) parent[v] = v;
    for (const auto& [a, b, c] : joined_.triangles) {
        const std::uint32_t roots[] = {find_root(a), find_root(b), find_root(c)};
        const std::uint32_t least = std::min({roots[0], roots[1], roots[2]});
        for (const std::uint32_t v : {roots[0], roots[1], roots[2], a, b, c}) parent[v] = least;
    }
    // a parent has a smaller number than its child, so one pass leads every vertex to its root
    for (std::uint32_t v = 0; v < parent_.size(); ++v) parent[v] = parent[parent[v]];
    const std::vector<Eigen::Vector3d>& p = joined_.vertices;
    components_.assign(keys_.size(), Component{});
    for (const auto& [a, b, c] : joined_.triangles) {
        const std::uint32_t root = parent[a];
        const Eigen::Vector3d& from = p[root];  // a vertex near by reduces cancellation
        components_[root].six_volumes += (p[a] - from).dot((p[b] - from).cross(p[c] - from));
    }
    for (std::uint32_t v = 0; v < keys_.size(); ++v) {
        if (may_be_needed_[v] != 0) components_[parent[v]].may_be_needed = true;
    }
}

void MeshAssembly::choose_components(const HullOptions& options, VisualHull& hull) {
    for (std::uint32_t v = 0; v < keys_.size(); ++v) {
        if (parent_[v] != v) continue;
        Component& component = components_[v];
        const bool is_fragment = component.six_volumes < 6.0 * options.min_component_volume_m3;
        component.is_kept = options.keep_phantoms || (component.may_be_needed && !is_fragment);
        if (component.is_kept) {
            ++hull.num_components;
            continue;
        }
        hull.volume_dropped_m3 += std::max(component.six_volumes, 0.0) / 6.0;
        if (!component.may_be_needed) {
            ++hull.num_phantoms_dropped;
        } else {
            ++hull.num_fragments_dropped;
        }
    }
}

void MeshAssembly::extract(const Cones& cones, const HullOptions& options, VisualHull& hull) {
    measure_components();
    choose_components(options, hull);
    output_index_.assign(keys_.size(), kNone);
    hull.mesh.vertices.resize(keys_.size());
    std::uint32_t num_vertices = 0;
    for (std::uint32_t v = 0; v < keys_.size(); ++v) {
        if (!components_[parent_[v]].is_kept) continue;
        output_index_[v] = num_vertices;
        hull.mesh.vertices[num_vertices++] = cones.to_site(joined_.vertices[v]);
    }
    hull.mesh.vertices.resize(num_vertices);
    hull.mesh.triangles.resize(joined_.triangles.size());
    auto triangle = hull.mesh.triangles.begin();
    for (const auto& [a, b, c] : joined_.triangles) {
        if (output_index_[a] == kNone) continue;
        *triangle++ = {output_index_[a], output_index_[b], output_index_[c]};
    }
    hull.mesh.triangles.erase(triangle, hull.mesh.triangles.end());
}

}  // namespace atrium::hull
