#pragma once

#include "core/base/executor.hpp"
#include "site_node/hull/cones.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace atrium::hull {

/// The rays of one camera in the pencil of half-planes around its baseline to another camera. A
/// half-plane meets a strip of the one and a strip of the other cone in one point at most, and a
/// ray lies in exactly one, so the order of all rays around the baseline decides which ray pierces
/// which strip. It is decided here, once, for both roles.
///
/// Indices are local: ray - view.first.
struct PencilSide {
    std::vector<double> angle;            // pseudo-angle around the baseline in [-2, 2)
    std::vector<Eigen::Vector2d> across;  // ray in the plane across the baseline
    // strip normal times baseline (this centre -> other centre) [m], and its inverse
    std::vector<double> offset;
    std::vector<double> inverse_offset;
    std::vector<std::uint32_t> sorted;    // own rays by angle
    std::vector<std::uint32_t> position;  // inverse of `sorted`
    std::vector<std::uint32_t> rank;      // number of the other camera's rays before this ray
    // strip g runs towards greater angles from ray g to ray next[g]
    std::vector<std::uint8_t> rises;
    // positions of the rays with the smaller (0) and the greater angle (1) of the two that bound
    // strip g
    std::vector<std::array<std::uint32_t, 2>> end_positions;
};

/// sides[i * num_views + k]: rays of view i in the pencil of i and k.
struct Pencils {
    std::size_t num_views = 0;
    std::vector<PencilSide> sides;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    std::vector<std::vector<std::pair<double, std::uint32_t>>> sort_buffers;  // one per worker

    const PencilSide& side(std::size_t i, std::size_t k) const { return sides[i * num_views + k]; }
    PencilSide& side(std::size_t i, std::size_t k) { return sides[i * num_views + k]; }
};

void build_pencils(const Cones& cones, Executor& executor, Pencils& pencils);

}  // namespace atrium::hull
