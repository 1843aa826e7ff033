#include "site_node/silhouette/silhouette.hpp"

#include "core/base/resize_keeping.hpp"
#include "site_node/silhouette/undistort_polygon.hpp"

#include <algorithm>
#include <cassert>

namespace atrium::silhouette {
namespace {

enum DropReason : std::uint8_t { kKept = 0, kNotUndistorted = 1, kNotSimple = 2 };

// Each round refines conflicts by one level. Thin parts side by side may create new conflicts in
// every round; such contours then keep all their points, which never meet.
constexpr int kMaxRounds = 10;

class Extraction {
public:
    Extraction(const geometry::PinholeCamera& intrinsics,
               const SilhouetteOptions& options,
               SilhouetteScratch& scratch)
        : intrinsics_(intrinsics), options_(options), scratch_(scratch) {}

    void fit_all() {
        const std::size_t n = scratch_.contours.contours.size();
        // callers may have swapped the outlines
        if (scratch_.outlines.size() < n) scratch_.outlines.resize(n);
        if (scratch_.segments_of_edges.size() < n) scratch_.segments_of_edges.resize(n);
        if (scratch_.polygons.size() < n) scratch_.polygons.resize(n);
        scratch_.dropped.assign(n, kKept);
        for (std::size_t c = 0; c < n; ++c) {
            fit_outline(points(c), options_.tolerance_px, scratch_.outline, scratch_.outlines[c]);
            rebuild(c);
        }
    }

    void make_simple() {
        const std::size_t n = scratch_.contours.contours.size();
        const std::span<const SilhouettePolygon> polygons(scratch_.polygons.data(), n);
        for (int round = 0;; ++round) {
            find_conflicts(polygons, scratch_.grid, scratch_.conflicts);
            mark_inverted();
            if (scratch_.conflicts.empty()) return;
            std::sort(scratch_.conflicts.begin(),
                      scratch_.conflicts.end(),
                      [](EdgeConflict a, EdgeConflict b) {
                          return a.polygon != b.polygon ? a.polygon < b.polygon : a.edge < b.edge;
                      });
            bool refined = false;
            for (std::size_t i = 0; i < scratch_.conflicts.size(); i = end_of_polygon(i))
                refined |= refine_from(i, round < kMaxRounds);
            if (!refined) drop_conflicts();
        }
    }

    // Also drops contours inside a dropped one: without it they would be inside out.
    void drop_what_lies_inside() {
        const std::size_t n = scratch_.contours.contours.size();
        for (std::size_t outer = 0; outer < n; ++outer) {
            if (scratch_.dropped[outer] == kKept) continue;
            for (std::size_t c = 0; c < n; ++c) {
                if (scratch_.dropped[c] == kKept && encloses(points(outer), points(c).front())) {
                    scratch_.dropped[c] = scratch_.dropped[outer];
                }
            }
        }
    }

private:
    std::span<const GridPoint> points(std::size_t c) const {
        return scratch_.contours.points_of(scratch_.contours.contours[c]);
    }

    void rebuild(std::size_t c) {
        SilhouettePolygon& polygon = scratch_.polygons[c];
        polygon.is_hole = scratch_.contours.contours[c].area_px < 0;
        if (!undistort_polygon(scratch_.outlines[c].vertices_px,
                               intrinsics_,
                               polygon.vertices_px,
                               scratch_.segments_of_edges[c])) {
            drop(c, kNotUndistorted);
        }
    }

    void drop(std::size_t c, DropReason reason) {
        scratch_.dropped[c] = reason;
        scratch_.polygons[c].vertices_px.clear();
    }

    // A polygon of a few pixels may have become flat or inverted: all its edges conflict.
    void mark_inverted() {
        for (std::uint32_t c = 0; c < scratch_.contours.contours.size(); ++c) {
            const SilhouettePolygon& polygon = scratch_.polygons[c];
            if (scratch_.dropped[c] != kKept) continue;
            const double area = signed_area_px(polygon);
            if (polygon.is_hole ? area < 0.0 : area > 0.0) continue;
            for (std::uint32_t k = 0; k < polygon.vertices_px.size(); ++k)
                scratch_.conflicts.push_back({c, k});
        }
    }

    // Returns the index of the first conflict of the next polygon.
    std::size_t end_of_polygon(std::size_t i) const {
        const std::uint32_t c = scratch_.conflicts[i].polygon;
        while (i < scratch_.conflicts.size() && scratch_.conflicts[i].polygon == c) ++i;
        return i;
    }

    // Refines the polygon of conflict `i` where it conflicts, or down to its contour points.
    // Returns false if it already consists of them.
    bool refine_from(std::size_t i, bool by_one_level) {
        const std::uint32_t c = scratch_.conflicts[i].polygon;
        Outline& outline = scratch_.outlines[c];
        if (consists_of_points(outline, points(c))) return false;
        if (by_one_level) {
            scratch_.outline.marked.assign(outline.segments.size(), 0);
            for (const std::size_t end = end_of_polygon(i); i < end; ++i) {
                scratch_.outline.marked[scratch_.segments_of_edges[c][scratch_.conflicts[i].edge]] =
                    1;
            }
            refine_outline(points(c), options_.tolerance_px, scratch_.outline, outline);
        } else {
            use_contour_points(points(c), outline);
        }
        rebuild(c);
        return true;
    }

    static bool consists_of_points(const Outline& outline, std::span<const GridPoint> contour) {
        return outline.segments.size() == contour.size() &&
               std::all_of(outline.segments.begin(),
                           outline.segments.end(),
                           [](const OutlineSegment& segment) { return segment.pinned; });
    }

    void drop_conflicts() {
        for (const EdgeConflict& conflict : scratch_.conflicts) drop(conflict.polygon, kNotSimple);
    }

    // Even-odd rule along a ray to the left, at a height without contour points (points are
    // half-pixels).
    static bool encloses(std::span<const GridPoint> contour, GridPoint p) {
        bool inside = false;
        for (std::size_t i = 0; i < contour.size(); ++i) {
            const GridPoint a = contour[i];
            const GridPoint b = contour[i + 1 < contour.size() ? i + 1 : 0];
            if ((2 * a.y > 2 * p.y + 1) == (2 * b.y > 2 * p.y + 1)) continue;
            // a step has at most one unit in y: the ray crosses it in the middle
            inside ^= a.x + b.x < 2 * p.x;
        }
        return inside;
    }

    const geometry::PinholeCamera& intrinsics_;
    const SilhouetteOptions& options_;
    SilhouetteScratch& scratch_;
};

}  // namespace

double signed_area_px(const SilhouettePolygon& polygon) {
    double twice = 0.0;
    for (std::size_t i = 0; i < polygon.vertices_px.size(); ++i) {
        const Eigen::Vector2d& a = polygon.vertices_px[i];
        const Eigen::Vector2d& b =
            polygon.vertices_px[i + 1 < polygon.vertices_px.size() ? i + 1 : 0];
        twice += a.x() * b.y() - a.y() * b.x();
    }
    return 0.5 * twice;
}

SilhouetteCounts extract_silhouette(const image::Mask& mask,
                                    const geometry::PinholeCamera& intrinsics,
                                    const SilhouetteOptions& options,
                                    SilhouetteScratch& scratch,
                                    std::vector<SilhouettePolygon>& out,
                                    std::span<const image::PixelSpan> rows) {
    assert(options.tolerance_px >= 0.25 && options.min_area_px >= 1);
    trace_contours(mask, options.min_area_px, scratch.contours, rows);
    Extraction extraction(intrinsics, options, scratch);
    extraction.fit_all();
    extraction.make_simple();
    extraction.drop_what_lies_inside();

    SilhouetteCounts counts;
    counts.num_small = scratch.contours.num_small;
    std::size_t num_kept = 0;
    for (std::size_t c = 0; c < scratch.contours.contours.size(); ++c) {
        counts.num_not_undistorted += scratch.dropped[c] == kNotUndistorted;
        counts.num_not_simple += scratch.dropped[c] == kNotSimple;
        if (scratch.dropped[c] != kKept) continue;
        counts.touches_border |= scratch.contours.contours[c].touches_border;
        if (num_kept == out.size()) resize_keeping(out, num_kept + 1, scratch.spare);
        out[num_kept].is_hole = scratch.polygons[c].is_hole;
        out[num_kept].vertices_px.assign(scratch.polygons[c].vertices_px.begin(),
                                         scratch.polygons[c].vertices_px.end());
        ++num_kept;
    }
    resize_keeping(out, num_kept, scratch.spare);
    return counts;
}

}  // namespace atrium::silhouette
