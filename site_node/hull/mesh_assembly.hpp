#pragma once

#include "site_node/hull/strip_sweep.hpp"
#include "site_node/hull/visual_hull.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::hull {

/// Joins the faces of all runs into one mesh, by vertex identity only.
class MeshAssembly {
public:
    /// Numbers the vertices of all runs. False if a vertex was named but never placed.
    bool join(const Cones& cones, std::span<const RunFaces> runs);

    // The next two may run at the same time.

    /// True if the joined faces are a closed 2-manifold: every vertex has three faces, every edge
    /// has its twin, and no two faces use the same diagonal. Combinatorial; positions are not
    /// looked at.
    bool verify(const Cones& cones, std::span<const RunFaces> runs);

    /// Chooses the components and writes the mesh, in the site frame, over what `hull` had before.
    void extract(const Cones& cones,
                 std::span<const RunFaces> runs,
                 const HullOptions& options,
                 VisualHull& hull);

    /// Closed, and the triangles around each vertex form one cycle; for any mesh. `verify` is
    /// faster where three faces meet in every vertex.
    bool is_manifold(const geometry::TriangleMesh& mesh);

private:
    struct HalfEdge {
        std::uint64_t ends = 0;    // first corner's vertex, second corner's vertex
        std::uint32_t corner = 0;  // 3 * triangle + place of the first one
    };
    struct Slot {
        VertexKey key = 0;  // 0: free; no vertex has strip 0 three times
        std::uint32_t index = 0;
    };
    struct Corners {  // neighbours of a vertex along the boundaries of its three faces
        std::array<std::uint32_t, 3> in;
        std::array<std::uint32_t, 3> out;
        std::uint8_t num_in = 0;
        std::uint8_t num_out = 0;
    };
    struct Component {
        double six_volumes = 0.0;
        bool has_viewing_edge = false;
        bool is_kept = false;
    };

    std::uint32_t index_of(VertexKey key);
    std::uint32_t find_root(std::uint32_t v);
    void unite(std::uint32_t a, std::uint32_t b);
    void measure_components(std::span<const RunFaces> runs);
    void choose_components(const HullOptions& options, VisualHull& hull);

    std::vector<Slot> slots_;
    std::vector<std::uint32_t> global_;     // of the vertices of all runs, one after the other
    std::vector<std::uint32_t> run_begin_;  // first entry of each run in `global_`
    std::vector<VertexKey> keys_;
    std::vector<Eigen::Vector3d> positions_;
    std::vector<std::uint8_t> is_placed_;
    std::vector<std::uint8_t> on_viewing_edge_;
    std::vector<Corners> corners_;
    std::vector<std::uint32_t> parent_;
    std::vector<Component> components_;  // by root vertex
    std::vector<std::uint32_t> output_index_;
    std::vector<HalfEdge> half_edges_;
};

}  // namespace atrium::hull
