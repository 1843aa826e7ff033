#pragma once

#include "core/base/executor.hpp"
#include "core/geometry/aabb.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "core/geometry/rigid_transform.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace atrium::hull {

/// The silhouettes of one camera at one instant.
///
/// Contours are closed polygons in undistorted pixels; the first vertex is not repeated. The
/// even-odd rule defines the inside, so holes need no mark, and orientation and start do not
/// matter.
struct SilhouetteView {
    geometry::PinholeCamera intrinsics;  // distortion is ignored: contours are undistorted
    geometry::RigidTransform camera_from_site;
    std::vector<std::vector<Eigen::Vector2d>> contours;  // empty: the camera sees nobody
    /// The part of the picture where the silhouettes are complete. Empty: the whole picture plane;
    /// the camera carves everything outside its contours. Otherwise a simple polygon in undistorted
    /// pixels, slightly inside the border of the image: what lies beyond is unknown, and the camera
    /// carves only the background inside it.
    std::vector<Eigen::Vector2d> field;
};

struct HullOptions {
    /// The hull is cut at this box, site frame [m]. Required if no camera, or only partial views
    /// (`SilhouetteView::field`), bound the hull.
    std::optional<geometry::Aabb> bounds;
    /// Minimum number of cameras that must see each point of the hull. A camera with a field sees
    /// the inside of its field; a camera without one sees the inside of its contours.
    std::uint32_t min_views = 0;
    /// Keeps components that no silhouette needs (phantoms): those without any viewing edge, and
    /// those whose silhouettes other components explain. They are part of the exact intersection.
    bool keep_phantoms = false;
    /// Drops components smaller than this, unless phantoms are kept. 5 ml is less than a hand.
    double min_component_volume_m3 = 5e-6;
    /// Drops contours with less area, and counts them.
    double min_contour_area_px2 = 1e-2;
    /// Decides everything in integers, without the floating-point filter: slow, and the same
    /// result.
    bool only_exact = false;
    /// Limits; kTooComplex beyond them. A person from 8 views has 2 k segments and needs 2 M steps;
    /// from 64 views 13 k segments and about 500 M steps. 1 G steps take about 5 s.
    std::size_t max_segments = 200'000;
    std::uint64_t max_steps = 1'000'000'000;
};

enum class HullStatus : std::uint8_t {
    kOk,
    kTooFewViews,        // fewer than two different views; with bounds, none
    kEmptyIntersection,  // no point of space is inside all silhouettes, or all components were
                         // dropped
    kUnbounded,          // the intersection extends to infinity
    kInvalidInput,       // not finite, invalid intrinsics or rotation, or more than kMaxViews views
    kTooComplex,         // beyond max_segments, max_steps or the limits of input_limits.hpp
    kNumericFailure,     // no attempt gave a closed 2-manifold
};

const char* to_string(HullStatus status);

inline constexpr std::size_t kMaxViews = 64;  // one bit per view in a 64-bit word

struct StageTimes {
    double silhouettes_ms = 0.0;  // check and repair polygons, compute viewing rays
    double pencils_ms = 0.0;      // order the rays of each pair of cameras around its baseline
    double sweep_ms = 0.0;        // find faces and triangulate them
    double assembly_ms = 0.0;     // join by vertex identity, verify, find components
    double total_ms = 0.0;
};

struct VisualHull {
    HullStatus status = HullStatus::kTooFewViews;
    /// Site frame [m]. A closed 2-manifold, counter-clockwise seen from outside. Empty unless
    /// status is kOk.
    geometry::TriangleMesh mesh;
    // Counts of components: 0 if no attempt was completed.
    std::uint32_t num_components = 0;         // kept
    std::uint32_t num_phantoms_dropped = 0;   // no silhouette needs them
    std::uint32_t num_fragments_dropped = 0;  // others below min_component_volume_m3
    double volume_dropped_m3 = 0.0;           // volume of phantoms and fragments
    std::uint32_t num_contours_dropped = 0;   // too small, or still crossing after all repairs
    std::uint32_t num_contours_repaired = 0;  // crossings of outlines that were resolved
    std::uint32_t num_views_merged = 0;       // views equal to another one in camera and contours
    std::uint32_t num_attempts = 0;           // jitters tried; 1 unless the input is degenerate
    std::uint32_t num_regions_failed = 0;     // see regions.hpp
    StageTimes times;
};

/// Resets `hull`, but keeps the memory of the mesh.
void clear(VisualHull& hull);

/// Working memory of one caller. Grows to the largest input and is then reused.
class HullScratch {
public:
    HullScratch();
    ~HullScratch();
    HullScratch(HullScratch&&) noexcept;
    HullScratch& operator=(HullScratch&&) noexcept;

    struct Data;
    Data& data() { return *data_; }
    const Data& data() const { return *data_; }

private:
    std::unique_ptr<Data> data_;
};

/// Computes the visual hull: the exact intersection of the viewing cones of all silhouettes. Every
/// vertex of the polyhedron is a vertex of the mesh; nothing is welded or simplified.
///
/// Silhouette points are jittered by 1e-6 px, repeatably, to give degenerate input a definite
/// result, and rays and centres are rounded to a grid of integers. All predicates on these are
/// exact (`exact_predicates.hpp`) and cannot contradict each other. Only the positions of vertices
/// are rounded. See docs/design/hull.md.
///
/// The result is the same, bit for bit, for any order of views and contours, any start and
/// orientation of contours, and any number of workers. Allocates only while `scratch` and `hull`
/// grow. Concurrent calls need separate scratch objects. Errors: `hull.status`.
///
/// The polyhedron is the one of Franco and Boyer, "Exact Polyhedral Visual Hulls" (BMVC 2003). The
/// algorithm differs: it does not walk from viewing edges, but sweeps each strip of each cone once,
/// with a kinetic list of the strips that cut it. This also finds components without viewing edges,
/// and the same sweep yields the triangles.
void compute_visual_hull(std::span<const SilhouetteView> views,
                         const HullOptions& options,
                         HullScratch& scratch,
                         Executor& executor,
                         VisualHull& hull);

/// The same, for views that are not contiguous in memory.
void compute_visual_hull(std::span<const SilhouetteView* const> views,
                         const HullOptions& options,
                         HullScratch& scratch,
                         Executor& executor,
                         VisualHull& hull);

/// The same, into a new result, on the calling thread.
VisualHull compute_visual_hull(std::span<const SilhouetteView> views,
                               const HullOptions& options,
                               HullScratch& scratch);

}  // namespace atrium::hull
