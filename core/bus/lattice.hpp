#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>

/// Places in 16 bits a coordinate.
namespace atrium::bus {

struct Lattice {
    Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
    double step_m = 1e-4;

    /// The nearest point of the lattice to a finite place.
    std::array<std::uint16_t, 3> coded(const Eigen::Vector3f& place) const;
};

/// The finest one that reaches around all of these finite places: each is off by half a step at
/// most. Steps are 1 um and more.
Lattice lattice_around(std::span<const Eigen::Vector3f> places);

}  // namespace atrium::bus
