#pragma once

#include "site_node/hull/visual_hull.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::hull {

/// All contours of one view in one array, as closed loops. The first point is not repeated.
struct Outlines {
    std::vector<Eigen::Vector2d> points;  // [px]
    std::vector<std::uint32_t> ends;      // contour c is points[ends[c-1], ends[c])

    void clear() {
        points.clear();
        ends.clear();
    }
    std::size_t num_contours() const { return ends.size(); }
    std::uint32_t begin_of(std::size_t c) const { return c == 0 ? 0 : ends[c - 1]; }
    std::span<const Eigen::Vector2d> contour(std::size_t c) const {
        return {points.data() + begin_of(c), ends[c] - begin_of(c)};
    }
    void append(std::span<const Eigen::Vector2d> loop) {
        points.insert(points.end(), loop.begin(), loop.end());
        ends.push_back(static_cast<std::uint32_t>(points.size()));
    }
};

struct OutlineCounts {
    std::uint32_t dropped = 0;
    std::uint32_t repaired = 0;
};

struct OutlineScratch {
    struct Edge {
        double low, high, left, right;  // bounding box [px]
        std::uint32_t from, to;         // indices of points
        std::uint32_t contour;
    };
    struct Crossing {
        std::uint32_t p, q;  // edges, named by their first points
        Eigen::Vector2d at;  // [px]
        Eigen::Vector2d bisector;
    };
    struct Cut {  // a crossing on one of its two edges
        std::uint32_t edge;
        double parameter;
        std::uint32_t crossing;
        bool is_p;
    };
    Outlines other;
    std::vector<Eigen::Vector2d> raw, loop;
    std::vector<std::uint32_t> order;
    std::vector<Edge> edges;
    std::vector<Crossing> crossings;
    std::vector<Cut> cuts;
    // one per node: the points, then both copies of each crossing
    std::vector<std::uint32_t> next;
    std::vector<Eigen::Vector2d> place;
    std::vector<double> room;  // [px]
    std::vector<std::uint8_t> is_done;
    std::vector<std::uint8_t> is_crossing;  // one per point of `loop`
    // one per contour
    std::vector<double> area;
    std::vector<std::uint8_t> is_dropped;
};

/// Returns the signed area. Positive for loops that run counter-clockwise in axes with +Y up; these
/// appear clockwise in an image, whose +Y points down. See `orient_by_nesting`.
double signed_area_px2(std::span<const Eigen::Vector2d> loop);

/// Returns the sum of the absolute areas of the triangle fan from the first point, an upper bound
/// of the enclosed area.
double swept_area_px2(std::span<const Eigen::Vector2d> loop);

/// Copies `contours` [px] into canonical form, without repeated points and spikes. The result does
/// not depend on the order of contours, their starting points or orientations. Leaves out loops
/// with `swept_area_px2` below `min_area_px2` and counts them in `counts.dropped`.
void copy_canonical(const std::vector<std::vector<Eigen::Vector2d>>& contours,
                    double min_area_px2,
                    OutlineScratch& scratch,
                    Outlines& out,
                    OutlineCounts& counts);

/// Moves every point by at most `amplitude_px` in x and in y. The offset is a pure function of
/// `seed`, position and index.
void jitter(Outlines& outlines, double amplitude_px, std::uint64_t seed);

/// Makes all loops simple and disjoint. Keeps the even-odd interior, up to 1e-3 px. A loop that
/// crosses itself is split at the crossing; two loops that cross are joined into one.
///
/// After 1000 repairs, contours that still cross are dropped, smallest first, and counted; so are
/// loops below `min_area_px2`. Touching or collinear loops have to be jittered apart before.
/// Returns false if the search needs more than `max_tests` segment tests.
bool make_simple(Outlines& outlines,
                 double min_area_px2,
                 std::uint64_t max_tests,
                 OutlineScratch& scratch,
                 OutlineCounts& counts);

/// Orients all loops: the foreground lies left of each one (+Y up), outer contours and holes alike.
void orient_by_nesting(Outlines& outlines);

/// Returns whether `p_px` is inside by the even-odd rule.
bool contains(std::span<const Eigen::Vector2d> loop, const Eigen::Vector2d& p_px);
bool contains(const Outlines& outlines, const Eigen::Vector2d& p_px);

/// Removes the contours whose bounding boxes do not meet `box` [px]. Returns their number. Inside
/// the box the even-odd interior stays the same.
std::uint32_t drop_outside(Outlines& outlines, const Eigen::AlignedBox2d& box);

}  // namespace atrium::hull
