#pragma once

#include "core/base/executor.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "site_node/refine/inward_sweep.hpp"
#include "site_node/refine/membrane.hpp"
#include "site_node/refine/split_edges.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::refine {

struct PhotoRefinementOptions {
    InwardSweepOptions sweep;
    /// Longer edges are divided where the surface between their ends bends by more than
    /// `least_bend_m`.
    float most_edge_m = 0.03F;
    float least_bend_m = 0.003F;
    /// Each such part of an outline holds one vertex, the one that would move least: in its place
    /// if that is at most `firm_move_m`, and ever less up to `free_move_m`, where the sweep and the
    /// outline contradict each other. A single vertex that stays far out would be a spike.
    double outline_bin_px = 2.0;
    float firm_move_m = 0.003F;
    float free_move_m = 0.008F;
    /// Smaller moves need no check against the silhouettes.
    float safe_move_m = 0.001F;
};

/// Moves the surface of a visual hull inwards to where the cameras agree in what they show of it
/// (InwardSweep): into hollows that no silhouette shows, and out of the volume that the hull adds
/// where few cameras look.
///
/// Parts that nobody has (PhantomParts) shrink to where they grow out of the body.
///
/// It remembers the mesh before: give the metaframes of one place to one object, in their order.
///
/// Deterministic, for any number of workers. Keeps its memory. Not thread-safe.
class PhotoRefinement {
public:
    explicit PhotoRefinement(const PhotoRefinementOptions& options = {})
        : options_(options), sweep_(options.sweep) {}

    /// Refines `mesh`, the visual hull of `views` or some components of it, also with rounded
    /// corners (CornerRounding), in place. It remains a closed 2-manifold with the same components;
    /// self-intersections are not checked. Vertices that moved are inside the masks of all views
    /// with a picture. False, and nothing changes, if the mesh is no closed 2-manifold or less than
    /// two views have pictures; then the mesh before is forgotten. A hull has at most
    /// hull::kMaxViews views.
    bool refine(geometry::TriangleMesh& mesh,
                std::span<const PictureView> views,
                Executor& executor);

    /// Forgets the mesh before.
    void forget() { sweep_.forget(); }

    const InwardSweep& sweep() const { return sweep_; }

private:
    struct LongEdge {
        SplitEdge edge;
        Eigen::Vector3f normal = Eigen::Vector3f::Zero();
        InwardSweep::Move move;
        bool bends = false;
    };

    void find_moves(const geometry::TriangleMesh& mesh, Executor& executor);
    void hold_outlines(const geometry::TriangleMesh& mesh, std::span<const PictureView> views);
    bool split_bent_edges(geometry::TriangleMesh& mesh, std::size_t first_new, Executor& executor);
    void shrink_phantoms(const geometry::TriangleMesh& mesh);
    void apply_moves(geometry::TriangleMesh& mesh,
                     std::span<const PictureView> views,
                     Executor& executor) const;

    PhotoRefinementOptions options_;
    InwardSweep sweep_;
    std::vector<Eigen::Vector3f> normals_;  // per vertex
    std::vector<Eigen::Vector3f> moves_;    // per vertex
    std::vector<float> phantoms_;           // per vertex: 0 to 1
    Membrane membrane_;
    std::vector<Eigen::Vector3f> places_;  // per vertex
    std::vector<NearScratch> near_;        // per worker
    std::vector<OutlinePoint> on_outlines_;
    std::vector<std::uint64_t>
        outlines_of_;  // per vertex: views whose outlines it lies on, as bits
    std::vector<LongEdge> long_edges_;
    std::vector<SplitEdge> splits_;
    std::vector<std::int32_t> face_owners_;  // per triangle: the camera that made it
};

}  // namespace atrium::refine
