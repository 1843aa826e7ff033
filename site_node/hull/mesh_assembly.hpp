#pragma once

#include "core/base/executor.hpp"
#include "core/geometry/closed_mesh.hpp"
#include "site_node/hull/cones.hpp"
#include "site_node/hull/strip_sweep.hpp"
#include "site_node/hull/visual_hull.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::hull {

/// Joins the faces of all runs into one mesh, by the identity of vertices only. Reuse one object;
/// it allocates only while it grows. Not thread-safe.
class MeshAssembly {
public:
    /// Writes the kept components as a mesh (site frame [m]) and the counts of components to
    /// `hull`, replacing what was there.
    ///
    /// Returns false, with an empty mesh and zero counts, unless the joined faces form a closed
    /// 2-manifold. This check is combinatorial; positions play no role.
    bool assemble(const Cones& cones,
                  std::span<const RunFaces> runs,
                  const HullOptions& options,
                  Executor& executor,
                  VisualHull& hull);

private:
    struct Slot {
        VertexKey key = 0;  // 0: free slot; no vertex has the key 0, which is strip 0 three times
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
        bool may_be_needed = false;
        bool is_kept = false;
    };

    std::size_t slot_of(VertexKey key) const {
        return static_cast<std::size_t>((key * 0x9e3779b97f4a7c15ULL) >> 20) & (slots_.size() - 1);
    }
    std::uint32_t index_of(VertexKey key);
    // Numbers the vertices of all runs. False if a vertex has no position.
    bool join(std::span<const RunFaces> runs);
    bool place(std::span<const RunFaces> runs);
    // Sufficient for a closed 2-manifold, and faster than a check of the triangles: every vertex
    // has three faces, every edge has its twin, and no two faces share a diagonal.
    bool has_three_faces_everywhere(std::span<const RunFaces> runs);
    void extract(const Cones& cones, const HullOptions& options, VisualHull& hull);
    std::uint32_t find_root(std::uint32_t v);
    void measure_components();
    void choose_components(const HullOptions& options, VisualHull& hull);

    std::vector<Slot> slots_;
    std::vector<std::uint32_t> global_;     // mesh index of each vertex, run after run
    std::vector<std::uint32_t> run_begin_;  // per run: its first entry in `global_`
    geometry::TriangleMesh joined_;         // all components; grid frame
    std::vector<VertexKey> keys_;
    std::vector<std::uint8_t> is_placed_;
    std::vector<std::uint8_t> may_be_needed_;
    std::vector<Corners> corners_;
    std::vector<std::uint32_t> parent_;
    std::vector<Component> components_;  // by root vertex
    std::vector<std::uint32_t> output_index_;
    geometry::ClosedMesh surface_;
};

}  // namespace atrium::hull
