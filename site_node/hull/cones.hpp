#pragma once

#include "core/base/executor.hpp"
#include "site_node/hull/clean_views.hpp"
#include "site_node/hull/exact_predicates.hpp"
#include "site_node/hull/field_of_view.hpp"
#include "site_node/hull/outlines.hpp"
#include "site_node/hull/visual_hull.hpp"

#include <Eigen/Core>

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace atrium::hull {

inline constexpr std::uint32_t kMaxStrips = (1u << 20) - 2;  // three ids name a vertex in 60 bits
inline constexpr std::uint32_t kNoStrip = std::numeric_limits<std::uint32_t>::max();

/// The cameras' statement about one region of space, one bit per camera.
struct Verdict {
    std::uint64_t carved = 0;  // the camera sees background there
    std::uint64_t seen = 0;    // partial views only: inside the field

    Verdict operator^(const Verdict& other) const {
        return {carved ^ other.carved, seen ^ other.seen};
    }
    Verdict& operator^=(const Verdict& other) { return *this = *this ^ other; }
    bool operator==(const Verdict&) const = default;
};

/// The viewing cones of all views.
///
/// A ray starts at a camera's centre and passes through one point of its silhouette. A strip is the
/// plane sector between the two rays of one segment. Ids of rays and strips run through all views,
/// chain by chain. They also name the vertices of the hull: a vertex is where three strips meet, or
/// a ray and a strip.
///
/// All numbers are integers on a grid (`exact_*`; steps of about 2e-8 px and 1 pm). The doubles
/// hold the same numbers without rounding. The axes of the grid are skewed against the site's axes.
/// Real rigs place cameras along the site's axes; on a grid aligned with these, rounding would move
/// many jittered rays back into a common plane.
struct Cones {
    struct View {
        Eigen::Vector3d centre;  // grid frame [m]
        exact::Vector exact_centre{};
        Eigen::Vector3d axis;              // viewing direction, grid frame
        Eigen::Matrix3d camera_from_grid;  // rotation only
        bool is_bounds = false;            // a corner of the bounds instead of a camera
        bool is_partial = false;           // has a field; unknown outside it
        double ray_unit = 1.0;             // of `exact_ray`
        std::uint32_t first_ray = 0;       // rays [first_ray, last_ray)
        std::uint32_t last_ray = 0;
        std::uint32_t first_strip = 0;
        std::uint32_t last_strip = 0;
    };
    struct Chain {
        std::uint32_t first_strip = 0;
        std::uint32_t last_strip = 0;  // one past
    };
    /// The bits of a verdict that change from one side of a strip to the other.
    struct Toggles {
        std::uint8_t bits = 0;  // 1: carved toggles, 2: seen toggles
        bool carves() const { return (bits & 1u) != 0; }
        Verdict of(std::uint32_t view) const {
            return {std::uint64_t{bits & 1u} << view, std::uint64_t{bits} >> 1u << view};
        }
    };
    struct Strip {
        std::uint32_t from = 0;  // rays; foreground lies left of from -> to
        std::uint32_t to = 0;
        std::uint32_t foreground_loop = 0;  // counted through all views
        std::uint32_t background_loop = 0;
        std::uint8_t view = 0;
        SegmentKind kind = SegmentKind::kSilhouette;
        // there is a face where no other camera carves and the number of other partial views that
        // see is in [min_seen, max_seen]
        std::uint32_t min_seen = 0;
        std::uint32_t max_seen = 64;
    };
    struct Incidence {  // the strips that share a ray: 2, or 3 where a silhouette leaves the field
        std::array<std::uint32_t, 3> strips{kNoStrip, kNoStrip, kNoStrip};
        std::uint32_t count = 0;
    };

    std::vector<View> views;
    Eigen::Matrix3d grid_from_site = Eigen::Matrix3d::Identity();  // rotation only
    Eigen::Vector3d origin;  // of the grid frame: mean of the camera centres [m, site frame]
    double centre_unit_m = 1.0;
    std::uint32_t min_seen = 0;  // number of partial views that must see a point of the hull

    bool only_exact = false;  // see HullOptions

    std::vector<Eigen::Vector3d> ray;  // grid frame; depth about 1 along the camera's axis
    std::vector<double> ray_length;
    std::vector<exact::Vector> exact_ray;
    std::vector<Incidence> incidence;  // by ray
    std::vector<Strip> strips;
    std::vector<Toggles> toggles;         // of each strip; apart because read far more often
    std::vector<Eigen::Vector3d> normal;  // of each strip; points out of the cone
    std::vector<double> normal_bound;     // of each strip: |along| |ray|; scales its errors
    std::vector<Chain> chains;
    std::uint32_t num_loops = 0;

    std::size_t num_views() const { return views.size(); }
    Eigen::Vector3d to_site(const Eigen::Vector3d& p_grid) const {
        return grid_from_site.transpose() * p_grid + origin;
    }
    exact::Vector exact_baseline(std::size_t from, std::size_t to) const {
        const exact::Vector& a = views[from].exact_centre;
        const exact::Vector& b = views[to].exact_centre;
        return {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    }
    bool has_face(const Strip& strip, const Verdict& others) const {
        if (others.carved != 0) return false;
        if (min_seen == 0) return true;
        const auto seen = static_cast<std::uint32_t>(std::popcount(others.seen));
        return strip.min_seen <= seen && seen <= strip.max_seen;
    }
    /// The verdict of a view on points outside all its outlines.
    Verdict verdict_beyond(std::size_t view) const {
        return {views[view].is_partial ? 0 : std::uint64_t{1} << view, 0};
    }
};

struct ConeScratch {
    struct View {
        LabelledOutlines labelled;
        std::vector<Eigen::Vector3d> rays;  // grid frame, not yet rounded
        OutlineCounts counts;
        HullStatus status = HullStatus::kOk;
        bool sees_nobody = false;
        std::uint32_t first_loop = 0;  // of this view; loop numbers run through all views
    };
    struct Worker {
        Outlines outlines;
        Outlines field;
        FieldScratch field_scratch;
        OutlineScratch outline;
    };
    std::vector<View> views;
    std::vector<Worker> workers;
};

/// Builds the cones of one attempt: jitters the outlines, makes them simple polygons, and puts rays
/// and centres on the grid.
///
/// `attempt` counts from 0; each attempt multiplies the jitter by 10. Writes the counts of contours
/// in `hull`. Runs on `executor`, one task per view. Errors: kTooComplex (too many strips, rays or
/// segment tests), kNumericFailure (contours and field of a view contradict each other),
/// kEmptyIntersection (a camera without a field sees nobody, or there are fewer cameras than
/// `min_views`). Never kInvalidInput.
HullStatus build_cones(const CleanViews& clean,
                       const HullOptions& options,
                       std::uint32_t attempt,
                       Executor& executor,
                       ConeScratch& scratch,
                       Cones& cones,
                       VisualHull& hull);

/// Returns the cones of the last computation with `scratch`, exactly as they were intersected.
const Cones& intersected_cones(const HullScratch& scratch);

}  // namespace atrium::hull
