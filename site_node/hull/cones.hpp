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

inline constexpr std::uint32_t kMaxStrips = (1u << 20) - 2;  // three name a vertex in 60 bits
inline constexpr std::uint32_t kNoStrip = std::numeric_limits<std::uint32_t>::max();

/// What the cameras say about a piece of space, one bit each.
struct Verdict {
    std::uint64_t carved = 0;  // sees background there
    std::uint64_t seen = 0;    // partial views only: has it inside of its field

    Verdict operator^(const Verdict& other) const {
        return {carved ^ other.carved, seen ^ other.seen};
    }
    Verdict& operator^=(const Verdict& other) { return *this = *this ^ other; }
    bool operator==(const Verdict&) const = default;
};

/// The viewing cones of all views.
///
/// A ray starts at its camera's centre and passes through one point of the silhouette; a strip is
/// the sector of a plane between two rays, over one segment. Ids run through all views, chain by
/// chain. They name everything else: a vertex of the hull is the meeting of three strips, or of a
/// ray and a strip.
///
/// All numbers are integers on a grid (`exact_*`, some 2e-8 px and 1 pm); the doubles are
/// the same numbers without rounding. The grid's axes are askew to the site's: real rigs have
/// cameras along those, and on a grid of the same directions many rays that the jitter has moved
/// apart would be in one plane again.
struct Cones {
    struct View {
        Eigen::Vector3d centre;  // grid frame [m]
        exact::Vector exact_centre{};
        Eigen::Vector3d axis;              // viewing direction, grid frame
        Eigen::Matrix3d camera_from_grid;  // rotation only
        bool is_bounds = false;            // a corner of the bounds instead of a camera
        bool is_partial = false;           // what lies outside of its outlines is unknown
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
    /// What changes from one side of a strip to the other.
    struct Toggles {
        std::uint8_t bits = 0;  // 1: carved, 2: seen
        bool carves() const { return (bits & 1u) != 0; }
        Verdict of(std::uint32_t view) const {
            return {std::uint64_t{bits & 1u} << view, std::uint64_t{bits} >> 1u << view};
        }
    };
    struct Strip {
        std::uint32_t from = 0;  // rays; foreground lies left of the way
        std::uint32_t to = 0;
        std::uint32_t foreground_loop = 0;  // counted through all views
        std::uint32_t background_loop = 0;
        std::uint8_t view = 0;
        SegmentKind kind = SegmentKind::kSilhouette;
        // there is a face where nobody carves and the number of other partial views that see is in
        // [min_seen, max_seen]
        std::uint32_t min_seen = 0;
        std::uint32_t max_seen = 64;
    };
    struct Incidence {  // strips that meet in a ray: 2, or 3 where a silhouette leaves the field
        std::array<std::uint32_t, 3> strips{kNoStrip, kNoStrip, kNoStrip};
        std::uint32_t count = 0;
    };

    std::vector<View> views;
    Eigen::Matrix3d grid_from_site = Eigen::Matrix3d::Identity();  // rotation only
    Eigen::Vector3d origin;  // of the grid frame: mean of the camera centres, site frame
    double centre_unit_m = 1.0;
    std::uint32_t min_seen = 0;  // partial views that have to see a point of the hull

    bool only_exact = false;  // see HullOptions

    std::vector<Eigen::Vector3d> ray;  // grid frame; depth about 1 along the camera's axis
    std::vector<double> ray_length;
    std::vector<exact::Vector> exact_ray;
    std::vector<Incidence> incidence;  // by ray
    std::vector<Strip> strips;
    std::vector<Toggles> toggles;  // of each strip; apart, since they are read far more often
    std::vector<Eigen::Vector3d> normal;  // of each strip, outwards
    std::vector<double> normal_bound;     // |along| |ray| of each strip, scales its rounding errors
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
    /// A view's verdict on what none of its outlines surrounds.
    Verdict verdict_beyond(std::size_t view) const {
        return {views[view].is_partial ? 0 : std::uint64_t{1} << view, 0};
    }
};

struct ConeScratch {
    struct View {
        LabelledOutlines labelled;
        std::vector<Eigen::Vector3d> rays;  // before they are rounded
        OutlineCounts counts;
        HullStatus status = HullStatus::kOk;
        bool sees_nobody = false;
        std::uint32_t first_loop = 0;  // of this view, counted through all views
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

/// Once per attempt: jitter, simple polygons, rays on the grid. Never kInvalidInput.
HullStatus build_cones(const CleanViews& clean,
                       const HullOptions& options,
                       std::uint32_t attempt,
                       Executor& executor,
                       ConeScratch& scratch,
                       Cones& cones,
                       VisualHull& hull);

/// The cones of the last computation: exactly what was intersected.
const Cones& intersected_cones(const HullScratch& scratch);

}  // namespace atrium::hull
