#pragma once

#include "core/base/executor.hpp"
#include "site_node/hull/cones.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace atrium::hull {

/// The rays and strips of one camera in the pencil of half-planes around its baseline to another
/// camera. A half-plane meets a strip of the one and a strip of the other cone in one point at
/// most, and a ray lies in exactly one, so the order of all rays around the baseline decides which
/// ray pierces which strip. It is decided here, once and exactly, for both roles.
///
/// Indices are local: ray - view.first_ray, strip - view.first_strip.
struct PencilSide {
    std::vector<Eigen::Vector2d> across;  // ray in the plane across the baseline
    std::vector<std::uint32_t> sorted;    // own rays by angle around the baseline
    std::vector<std::uint32_t> position;  // inverse of `sorted`
    std::vector<std::uint32_t> rank;      // number of the other camera's rays before this ray
    // by ray, bit j: it is the end with the greater angle of its incident strip j
    std::vector<std::uint8_t> is_upper_end;
    /// All of one ray that strips of other cameras ask for, by position in `sorted`: the events of
    /// a strip are neighbours there, so loops over them read memory in order, one cache line a ray.
    /// After the last ray it comes again and again.
    struct alignas(64) InOrder {
        double across_x = 0.0, across_y = 0.0;  // `across`
        double x = 0.0, y = 0.0, z = 0.0;       // Cones::ray
        double length = 0.0;                    // Cones::ray_length
        // the strips whose greater (0) and whose smaller angle (1) this ray is; kNoStrip twice
        // unless exactly two strips meet in it and it is one of each
        std::array<std::uint32_t, 2> through{};
        std::uint32_t local = 0;  // `sorted`
    };
    std::vector<InOrder> in_order;
    static constexpr std::size_t kSpareRays = 3;
    double inverse_baseline = 0.0;  // 1 / distance of the two centres

    /// For the depth at which the strip cuts the other camera's rays.
    struct Offset {
        double inverse =
            0.0;  // 1 / (strip normal . (other centre - this centre)), 0: too uncertain
        double certain = 0.0;    // 1 / the least that the product can be without rounding errors
        double error = 0.0;      // of the product
        double dot_error = 0.0;  // of strip normal . ray, for a ray of length 1
    };
    std::vector<Offset> offset;
    std::vector<std::uint8_t> rises;  // the strip runs towards greater angles
    // positions of the strip's rays with the smaller (0) and the greater angle (1)
    std::vector<std::array<std::uint32_t, 2>> end_positions;
};

/// sides[i * num_views + k]: rays of view i in the pencil of i and k.
struct Pencils {
    struct Entry {  // a ray that is being sorted
        double angle = 0.0;
        double error = 0.0;
        std::uint32_t ray = 0;
    };
    std::size_t num_views = 0;
    std::vector<PencilSide> sides;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    struct Sorting {                      // of the rays of one camera
        std::vector<Entry> entries;       // by ray, counted from the camera's first
        std::vector<std::uint64_t> keys;  // by angle
        double largest_error = 0.0;
    };
    struct SortBuffers {
        std::array<Sorting, 2> sides;
        std::vector<std::uint64_t> merged;
        std::vector<std::uint32_t> run_ends;
    };
    std::vector<SortBuffers> sort_buffers;    // one per worker
    std::vector<std::uint8_t> is_degenerate;  // one per pair

    const PencilSide& side(std::size_t i, std::size_t k) const { return sides[i * num_views + k]; }
    PencilSide& side(std::size_t i, std::size_t k) { return sides[i * num_views + k]; }
};

/// False if two rays lie in one half-plane, or a strip in one: no general position.
bool build_pencils(const Cones& cones, Executor& executor, Pencils& pencils);

}  // namespace atrium::hull
