#pragma once

#include "site_node/hull/visual_hull.hpp"

#include <Eigen/Core>

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
    Outlines other;
    std::vector<std::uint32_t> order;
    std::vector<std::uint32_t> contour_of;
    std::vector<Eigen::Vector2d> loop;
};

/// Positive for loops that run counter-clockwise as seen with +Y up, that is, clockwise numbers in
/// image axes; see `orient_by_nesting`.
double signed_area_px2(std::span<const Eigen::Vector2d> loop);

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

/// Makes all loops simple and free of each other: a loop that crosses itself is split there, of two
/// that cross the smaller is dropped. False if that needs more than `max_tests` segment tests or
/// some hundred repairs.
bool make_simple(Outlines& outlines,
                 double min_area_px2,
                 std::uint64_t max_tests,
                 OutlineScratch& scratch,
                 OutlineCounts& counts);

/// Reverses loops so that the foreground lies left of each one, outer contours and holes alike.
void orient_by_nesting(Outlines& outlines);

/// Even-odd rule.
bool contains(const Outlines& outlines, const Eigen::Vector2d& p_px);

}  // namespace atrium::hull
