#include "site_node/silhouette/outline.hpp"

#include "site_node/silhouette/chord_bound.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace atrium::silhouette {
namespace {

constexpr std::uint8_t kMaxLevel = 4;  // at this level a segment is a single contour step
constexpr double kReach = 1.5;  // largest move of a vertex from its contour point, in tolerances
// Moving an edge also changes its neighbours a little: the second round corrects that.
constexpr int kNumBalancing = 2;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
}

// Contour index at which segment k ends; contour.size() means point 0.
std::size_t end_of(const Outline& outline, std::size_t k, std::size_t contour_size) {
    return k + 1 < outline.segments.size() ? outline.segments[k + 1].begin : contour_size;
}

GridPoint cyclic(std::span<const GridPoint> contour, std::size_t i) {
    return contour[i == contour.size() ? 0 : i];
}

// Returns the step between two contour points, exactly.
Eigen::Vector2d step_px(GridPoint from, GridPoint to) {
    return {0.5 * (to.x - from.x), 0.5 * (to.y - from.y)};
}

// Fits a line to the contour points [begin, end] by total least squares.
EdgeLine fitted_line(std::span<const GridPoint> contour, std::size_t begin, std::size_t end) {
    const GridPoint a = contour[begin];
    // sums over half pixels, relative to the first point
    std::int64_t sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0, twice_area = 0;
    std::int64_t last_x = 0, last_y = 0;
    for (std::size_t i = begin; i <= end; ++i) {
        const GridPoint p = cyclic(contour, i);
        const std::int64_t x = p.x - a.x;
        const std::int64_t y = p.y - a.y;
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
        syy += y * y;
        twice_area += last_x * y - last_y * x;
        last_x = x;
        last_y = y;
    }
    const auto n = static_cast<std::int64_t>(end - begin + 1);
    const auto cxx = static_cast<double>(n * sxx - sx * sx);
    const auto cxy = static_cast<double>(n * sxy - sx * sy);
    const auto cyy = static_cast<double>(n * syy - sy * sy);
    // the larger eigenvector of the covariance, in the formula without cancellation
    const double half_difference = 0.5 * (cxx - cyy);
    const double root = std::sqrt(half_difference * half_difference + cxy * cxy);
    const Eigen::Vector2d along = half_difference >= 0.0
                                      ? Eigen::Vector2d(half_difference + root, cxy)
                                      : Eigen::Vector2d(cxy, root - half_difference);
    const double scale = 0.5 / static_cast<double>(n);
    EdgeLine line;
    line.middle_px = scale * Eigen::Vector2d(static_cast<double>(sx), static_cast<double>(sy));
    line.normal = Eigen::Vector2d(along.y(), -along.x()).normalized();
    if (along.dot(Eigen::Vector2d(static_cast<double>(last_x), static_cast<double>(last_y))) <
        0.0) {
        line.normal = -line.normal;
    }
    line.bulge_px2 = 0.125 * static_cast<double>(twice_area);
    return line;
}

// Returns the meeting point of the edges before and after a contour point, relative to that point;
// a point between them if they are nearly parallel. `to_before` is the vector to the first point of
// the previous segment.
Eigen::Vector2d meeting_point(const Eigen::Vector2d& to_before,
                              const EdgeLine& before,
                              const EdgeLine& after,
                              double reach_px) {
    // below this, a small error of a line moves the vertex far along the edges
    constexpr double kMinSine = 0.1;
    const double offset_before = before.normal.dot(to_before + before.middle_px);
    const double offset_after = after.normal.dot(after.middle_px);
    const double sine = cross(before.normal, after.normal);
    if (std::abs(sine) >= kMinSine) {
        const Eigen::Vector2d move(
            (offset_before * after.normal.y() - offset_after * before.normal.y()) / sine,
            (offset_after * before.normal.x() - offset_before * after.normal.x()) / sine);
        if (move.squaredNorm() <= reach_px * reach_px) return move;
    }
    return 0.5 * (offset_before * before.normal + offset_after * after.normal);
}

void intersect_lines(std::span<const GridPoint> contour,
                     double tolerance_px,
                     OutlineScratch& scratch,
                     const Outline& outline) {
    const std::size_t n = outline.segments.size();
    for (std::size_t k = 0; k < n; ++k) {
        const std::size_t before = k == 0 ? n - 1 : k - 1;
        const Eigen::Vector2d to_before =
            step_px(contour[outline.segments[k].begin], contour[outline.segments[before].begin]);
        scratch.moves_px[k] = meeting_point(
            to_before, scratch.lines[before], scratch.lines[k], kReach * tolerance_px);
    }
}

// Moves each line by the mean distance between its edge and the contour.
void balance_areas(std::span<const GridPoint> contour,
                   double tolerance_px,
                   OutlineScratch& scratch,
                   const Outline& outline) {
    const std::size_t n = outline.segments.size();
    for (std::size_t k = 0; k < n; ++k) {
        const Eigen::Vector2d chord = step_px(contour[outline.segments[k].begin],
                                              cyclic(contour, end_of(outline, k, contour.size())));
        const Eigen::Vector2d& from = scratch.moves_px[k];
        const Eigen::Vector2d to = chord + scratch.moves_px[k + 1 < n ? k + 1 : 0];
        // area of the quadrangle between chord and edge
        const double chord_to_edge_px2 = 0.5 * cross(to, from - chord);
        const double length_px = std::max((to - from).norm(), 1.0);
        const double move_px = (scratch.lines[k].bulge_px2 + chord_to_edge_px2) / length_px;
        scratch.lines[k].middle_px +=
            std::clamp(move_px, -0.5 * tolerance_px, 0.5 * tolerance_px) * scratch.lines[k].normal;
    }
}

void place_vertices(std::span<const GridPoint> contour,
                    double tolerance_px,
                    OutlineScratch& scratch,
                    Outline& outline) {
    const std::size_t n = outline.segments.size();
    scratch.lines.resize(n);
    scratch.moves_px.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
        scratch.lines[k] =
            fitted_line(contour, outline.segments[k].begin, end_of(outline, k, contour.size()));
    }
    intersect_lines(contour, tolerance_px, scratch, outline);
    for (int i = 0; i < kNumBalancing; ++i) {
        balance_areas(contour, tolerance_px, scratch, outline);
        intersect_lines(contour, tolerance_px, scratch, outline);
    }
    outline.vertices_px.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
        outline.vertices_px[k] =
            snapped_px(contour[outline.segments[k].begin], scratch.moves_px[k]);
    }
}

void pin(std::span<const GridPoint> contour, std::size_t k, Outline& outline) {
    OutlineSegment& segment = outline.segments[k];
    if (segment.pinned) return;
    segment.pinned = true;
    outline.vertices_px[k] = snapped_px(contour[segment.begin], Eigen::Vector2d::Zero());
    // both edges at this vertex moved
    segment.unchecked = true;
    outline.segments[k == 0 ? outline.segments.size() - 1 : k - 1].unchecked = true;
}

void pin_all(std::span<const GridPoint> contour, Outline& outline) {
    outline.vertices_px.resize(outline.segments.size());
    for (std::size_t k = 0; k < outline.segments.size(); ++k) pin(contour, k, outline);
}

// Replaces marked segments, whose ends are pinned, by finer ones.
void split_marked(std::span<const GridPoint> contour,
                  double tolerance_px,
                  OutlineScratch& scratch,
                  Outline& outline) {
    scratch.segments.clear();
    scratch.moves_px.clear();  // holds the vertices here
    for (std::size_t k = 0; k < outline.segments.size(); ++k) {
        OutlineSegment segment = outline.segments[k];
        if (!scratch.marked[k]) {
            scratch.segments.push_back(segment);
            scratch.moves_px.push_back(outline.vertices_px[k]);
            continue;
        }
        const std::size_t end = end_of(outline, k, contour.size());
        segment.unchecked = true;
        segment.level = std::min<std::uint8_t>(segment.level + 1, kMaxLevel);
        scratch.breaks.clear();
        if (segment.level < kMaxLevel) {
            scratch.blurred.set_thickness_px(std::ldexp(tolerance_px, -segment.level));
            split_into_blurred_segments(
                contour, segment.begin, end, scratch.blurred, scratch.breaks);
        } else {
            for (std::size_t i = segment.begin; i < end; ++i)
                scratch.breaks.push_back(static_cast<std::uint32_t>(i));
        }
        for (const std::uint32_t begin : scratch.breaks) {
            segment.begin = begin;
            scratch.segments.push_back(segment);
            scratch.moves_px.push_back(snapped_px(contour[begin], Eigen::Vector2d::Zero()));
        }
    }
    outline.segments.swap(scratch.segments);
    outline.vertices_px.swap(scratch.moves_px);
}

// Pins vertices, then refines segments, until every edge keeps the tolerance. Terminates: pins
// stay, segments only get finer, and a single contour step fits exactly.
void repair(std::span<const GridPoint> contour,
            double tolerance_px,
            OutlineScratch& scratch,
            Outline& outline) {
    const std::int64_t tolerance = tolerance_units(tolerance_px);
    for (bool changed = true; changed;) {
        changed = false;
        bool split = false;
        const std::size_t n = outline.segments.size();
        scratch.marked.assign(n, 0);
        for (std::size_t k = 0; k < n; ++k) {
            if (!outline.segments[k].unchecked) continue;
            outline.segments[k].unchecked = false;
            const std::size_t next = k + 1 < n ? k + 1 : 0;
            if (all_within(contour,
                           outline.segments[k].begin,
                           end_of(outline, k, contour.size()),
                           outline.vertices_px[k],
                           outline.vertices_px[next],
                           tolerance))
                continue;
            changed = true;
            if (outline.segments[k].pinned && outline.segments[next].pinned) {
                scratch.marked[k] = 1;
                split = true;
            } else {
                pin(contour, k, outline);
                pin(contour, next, outline);
            }
        }
        if (split) split_marked(contour, tolerance_px, scratch, outline);
    }
}

}  // namespace

void fit_outline(std::span<const GridPoint> contour,
                 double tolerance_px,
                 OutlineScratch& scratch,
                 Outline& out) {
    assert(contour.size() >= 4);
    scratch.breaks.clear();
    scratch.blurred.set_thickness_px(tolerance_px);
    split_into_blurred_segments(contour, 0, contour.size(), scratch.blurred, scratch.breaks);
    out.segments.clear();
    for (const std::uint32_t begin : scratch.breaks) out.segments.push_back({.begin = begin});

    if (out.segments.size() >= 3) {
        place_vertices(contour, tolerance_px, scratch, out);
    } else {
        pin_all(contour, out);
    }
    // thin blobs: the whole contour may be one segment
    while (out.segments.size() < 3) {
        scratch.marked.assign(out.segments.size(), 1);
        split_marked(contour, tolerance_px, scratch, out);
    }
    repair(contour, tolerance_px, scratch, out);
}

void refine_outline(std::span<const GridPoint> contour,
                    double tolerance_px,
                    OutlineScratch& scratch,
                    Outline& outline) {
    const std::size_t n = outline.segments.size();
    assert(scratch.marked.size() == n);
    for (std::size_t k = 0; k < n; ++k) {
        if (!scratch.marked[k]) continue;
        pin(contour, k, outline);
        pin(contour, k + 1 < n ? k + 1 : 0, outline);
    }
    split_marked(contour, tolerance_px, scratch, outline);
    repair(contour, tolerance_px, scratch, outline);
}

void use_contour_points(std::span<const GridPoint> contour, Outline& outline) {
    outline.segments.clear();
    outline.vertices_px.clear();
    for (std::uint32_t i = 0; i < contour.size(); ++i) {
        outline.segments.push_back(
            {.begin = i, .level = kMaxLevel, .pinned = true, .unchecked = false});
        outline.vertices_px.push_back(snapped_px(contour[i], Eigen::Vector2d::Zero()));
    }
}

}  // namespace atrium::silhouette
