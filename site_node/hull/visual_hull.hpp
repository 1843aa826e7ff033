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

/// What one camera sees at one instant.
///
/// Contours are closed polygons in undistorted pixels, first vertex not repeated; inside by the
/// even-odd rule, so holes need no mark and orientation and start do not matter.
struct SilhouetteView {
    geometry::PinholeCamera intrinsics;  // distortion is ignored: contours are undistorted already
    geometry::RigidTransform camera_from_site;
    std::vector<std::vector<Eigen::Vector2d>> contours;  // empty: the camera sees nobody
    /// Empty: nobody is outside of the image; the camera cuts away all that its contours do not
    /// contain. Else a simple polygon in undistorted pixels, a little inside of the image's border:
    /// what lies beyond it is unknown, so that the camera cuts away only the background that it
    /// sees inside of it.
    std::vector<Eigen::Vector2d> field;
};

struct HullOptions {
    /// Where people can be, site frame [m]: the hull is cut there. Needed where no camera or only
    /// partial views (`SilhouetteView::field`) close the hull.
    std::optional<geometry::Aabb> bounds;
    /// A point of space is in the hull only if at least this many cameras see it, that is, have it
    /// inside of their field; a camera without a field sees all that its contours contain.
    std::uint32_t min_views = 0;
    /// Components without any viewing edge are part of the exact intersection, but no silhouette
    /// needs them.
    bool keep_phantoms = false;
    /// Components smaller than this are dropped as well, unless phantoms are kept. 5 ml: less than
    /// a hand.
    double min_component_volume_m3 = 5e-6;
    /// Contours with less area are dropped and counted.
    double min_contour_area_px2 = 1e-2;
    /// Every decision in integers, also where doubles are certain: slow, and the same result.
    bool only_exact = false;
    /// Limits for absurd input, kTooComplex beyond them. A person from 8 views has 2 k segments and
    /// needs 2 M steps, one from 64 views 13 k and some 500 M; 1 G steps take about 5 s.
    std::size_t max_segments = 200'000;
    std::uint64_t max_steps = 1'000'000'000;
};

enum class HullStatus : std::uint8_t {
    kOk,
    kTooFewViews,        // less than two different views
    kEmptyIntersection,  // no point of space is inside all silhouettes, or all components were
                         // dropped
    kUnbounded,          // the silhouettes leave directions open to infinity
    kInvalidInput,    // not finite, intrinsics or rotation that are none, more than kMaxViews views
    kTooComplex,      // beyond max_segments or max_steps
    kNumericFailure,  // no attempt gave a closed 2-manifold
};

const char* to_string(HullStatus status);

inline constexpr std::size_t kMaxViews = 64;  // one bit each in a word

struct StageTimes {
    double silhouettes_ms = 0.0;  // check and repair polygons, viewing rays
    double pencils_ms = 0.0;      // order the rays of each camera pair around its baseline
    double sweep_ms = 0.0;        // faces and their triangles
    double assembly_ms = 0.0;     // join by vertex identity, verify, components
    double total_ms = 0.0;
};

struct VisualHull {
    HullStatus status = HullStatus::kTooFewViews;
    /// Site frame [m], closed, 2-manifold, counter-clockwise from outside; empty unless status is
    /// kOk.
    geometry::TriangleMesh mesh;
    // Components: all 0 where no attempt came to its end.
    std::uint32_t num_components = 0;         // kept
    std::uint32_t num_phantoms_dropped = 0;   // without a viewing edge
    std::uint32_t num_fragments_dropped = 0;  // others below min_component_volume_m3
    double volume_dropped_m3 = 0.0;           // of phantoms and fragments
    std::uint32_t num_contours_dropped = 0;   // too small, or still crossing when repairs ran out
    std::uint32_t num_contours_repaired = 0;  // crossings of outlines that were taken apart
    std::uint32_t num_views_merged = 0;    // the same camera with the same contours as another one
    std::uint32_t num_attempts = 0;        // jitters tried; 1 unless the input is degenerate
    std::uint32_t num_regions_failed = 0;  // see regions.hpp
    StageTimes times;
};

/// Keeps the memory of the mesh.
void clear(VisualHull& hull);

/// Working memory of one caller; grows to the largest input and is then reused.
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

/// Intersects the viewing cones of all silhouettes, exactly: every vertex of the polyhedron is a
/// vertex of the mesh, and nothing is welded or simplified.
///
/// Silhouettes are moved by 1e-6 px at random, but repeatably, so that degenerate input has a
/// definite answer, and put on a grid of integers. What is decided about these is decided without
/// rounding (`exact_predicates.hpp`), so that decisions cannot contradict each other; only the
/// positions of the vertices are rounded. docs/design/hull.md explains it.
///
/// The order of views and contours, their starts and orientations do not change a bit of the
/// result, nor does the number of workers. Allocates only while `scratch` and
/// `hull` grow. Not thread-safe on the same scratch.
///
/// The polyhedron is the one of Franco, Boyer, "Exact Polyhedral Visual Hulls" (BMVC 2003). It is
/// found differently: instead of walking from viewing edges, each strip of each cone is swept once
/// by a kinetic list of the strips that cut it, so that components without viewing edges are found
/// too, and triangles come out of the same sweep.
void compute_visual_hull(std::span<const SilhouetteView> views,
                         const HullOptions& options,
                         HullScratch& scratch,
                         Executor& executor,
                         VisualHull& hull);

/// The same of views that are not one after the other.
void compute_visual_hull(std::span<const SilhouetteView* const> views,
                         const HullOptions& options,
                         HullScratch& scratch,
                         Executor& executor,
                         VisualHull& hull);

/// The same into a new result, on the calling thread.
VisualHull compute_visual_hull(std::span<const SilhouetteView> views,
                               const HullOptions& options,
                               HullScratch& scratch);

}  // namespace atrium::hull
