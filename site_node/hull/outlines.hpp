#pragma once

#include "site_node/hull/visual_hull.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::hull {

/// All contours of one view in one array, as closed loops.
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
        double low, high, left, right;  // its box [px]
        std::uint32_t from, to;         // points
        std::uint32_t contour;
    };
    struct Crossing {
        std::uint32_t p, q;  // edges, named by their first points
        Eigen::Vector2d at;  // [px]
        Eigen::Vector2d bisector;
    };
    struct Cut {  // one crossing's place on one of its two edges
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
    // of the points and then of both copies of each crossing
    std::vector<std::uint32_t> next;
    std::vector<Eigen::Vector2d> place;
    std::vector<double> room;  // [px]
    std::vector<std::uint8_t> is_done;
    std::vector<std::uint8_t> is_crossing;  // of the points of `loop`
    // of the contours
    std::vector<double> area;
    std::vector<std::uint8_t> is_dropped;
};

/// Positive for loops that run counter-clockwise as seen with +Y up, that is, clockwise numbers in
/// image axes; see `orient_by_nesting`.
double signed_area_px2(std::span<const Eigen::Vector2d> loop);

/// Sum of the triangles of the fan from the first point, all taken positive: no loop bounds more.
double swept_area_px2(std::span<const Eigen::Vector2d> loop);

/// Copies `contours` without repeated points and spikes into a form that does not depend on order,
/// start or orientation. Loops with less than `min_area_px2` are left out and counted.
void copy_canonical(const std::vector<std::vector<Eigen::Vector2d>>& contours,
                    double min_area_px2,
                    OutlineScratch& scratch,
                    Outlines& out,
                    OutlineCounts& counts);

/// Moves every point by at most `amplitude_px` in x and y; a pure function of `seed`, position and
/// index.
void jitter(Outlines& outlines, double amplitude_px, std::uint64_t seed);

/// Makes all loops simple and free of each other without changing what they enclose by the even-odd
/// rule (up to 1e-3 px): a loop that crosses itself is split there, two that cross are joined to
/// one. Where that takes more than a thousand repairs, of loops that still cross the smallest are
/// dropped and counted. False if all that needs more than `max_tests` segment tests. Degenerate
/// contacts have to be jittered away before.
bool make_simple(Outlines& outlines,
                 double min_area_px2,
                 std::uint64_t max_tests,
                 OutlineScratch& scratch,
                 OutlineCounts& counts);

/// Reverses loops so that the foreground lies left of each one, outer contours and holes alike.
void orient_by_nesting(Outlines& outlines);

/// Even-odd rule.
bool contains(std::span<const Eigen::Vector2d> loop, const Eigen::Vector2d& p_px);
bool contains(const Outlines& outlines, const Eigen::Vector2d& p_px);

/// Removes the contours whose bounding boxes do not meet `box` [px] and returns their number.
/// Inside of the box the even-odd rule gives the same as before.
std::uint32_t drop_outside(Outlines& outlines, const Eigen::AlignedBox2d& box);

}  // namespace atrium::hull
