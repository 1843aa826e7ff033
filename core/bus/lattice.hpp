#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>

/// Quantises points to 16 bits per coordinate.
namespace atrium::bus {

/// A regular grid of 65536 points per axis: p = origin_m + step_m * (x, y, z).
struct Lattice {
    Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
    double step_m = 1e-4;

    /// Returns the grid point nearest to a finite place, clamped to the grid.
    std::array<std::uint16_t, 3> quantised(const Eigen::Vector3f& place) const;
};

/// Returns the finest lattice that contains all of these finite places [m]. The error per
/// coordinate is at most half a step. The step is at least 1 um.
Lattice lattice_around(std::span<const Eigen::Vector3f> places);

}  // namespace atrium::bus
