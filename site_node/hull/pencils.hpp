#pragma once

#include "core/base/executor.hpp"
#include "site_node/hull/cones.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace atrium::hull {

/// The rays and strips of one camera in a pencil: the half-planes bounded by the baseline to
/// another camera. A half-plane meets a strip of either cone in at most one point, and each ray
/// lies in exactly one half-plane. The order of all rays around the baseline therefore decides
/// which ray pierces which strip. It is decided here, once and exactly, for both cameras.
///
/// Indices are local: ray - view.first_ray, strip - view.first_strip.
struct PencilSide {
    std::vector<Eigen::Vector2d> across;  // ray projected along the baseline onto a plane across it
    std::vector<std::uint32_t> sorted;    // rays of this camera, by angle around the baseline
    std::vector<std::uint32_t> position;  // inverse of `sorted`
    std::vector<std::uint32_t> rank;      // number of the other camera's rays before this ray
    // by ray; bit j: the ray is the end with the greater angle of its incident strip j
    std::vector<std::uint8_t> is_upper_end;
    /// All data of one ray that strips of other cameras need, by position in `sorted`. The events
    /// of a strip are neighbours in this order, so loops over them read memory in order, one cache
    /// line per ray. The last ray is repeated kSpareRays times.
    struct alignas(64) InOrder {
        double across_x = 0.0, across_y = 0.0;  // `across`
        double x = 0.0, y = 0.0, z = 0.0;       // Cones::ray
        double length = 0.0;                    // Cones::ray_length
        // the strip that has its greater angle (0) and the one that has its smaller angle (1) at
        // this ray; both kNoStrip unless exactly two strips meet here and it is one of each
        std::array<std::uint32_t, 2> through{};
        std::uint32_t local = 0;  // `sorted`
    };
    std::vector<InOrder> in_order;
    static constexpr std::size_t kSpareRays = 3;
    double inverse_baseline = 0.0;  // 1 / distance of the two centres [1/m]

    /// Data for 1 / depth where the plane of the strip cuts a ray of the other camera.
    struct Offset {
        double inverse = 0.0;    // 1 / product, with product = strip normal . (other centre - this
                                 // centre); 0: too uncertain
        double certain = 0.0;    // 1 / lower bound of |product|
        double error = 0.0;      // bound of the rounding error of the product
        double dot_error = 0.0;  // of (strip normal . ray), for a ray of length 1
    };
    std::vector<Offset> offset;
    std::vector<std::uint8_t> rises;  // by strip: its angle rises from its first ray to its second
    // positions of the strip's ray with the smaller (0) and the greater angle (1)
    std::vector<std::array<std::uint32_t, 2>> end_positions;
};

/// The pencils of all pairs of views. sides[i * num_views + k]: rays of view i in the pencil of i
/// and k.
struct Pencils {
    struct Entry {  // a ray during sorting
        double angle = 0.0;
        double error = 0.0;
        std::uint32_t ray = 0;
    };
    std::size_t num_views = 0;
    std::vector<PencilSide> sides;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    struct Sorting {                      // the rays of one camera during sorting
        std::vector<Entry> entries;       // by local ray
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

/// Builds the pencils of all pairs of views, on `executor`, one task per pair. Allocates only while
/// `pencils` grows.
///
/// Returns false if the input is not in general position: a half-plane of a pencil contains two
/// rays, or a strip.
bool build_pencils(const Cones& cones, Executor& executor, Pencils& pencils);

}  // namespace atrium::hull
