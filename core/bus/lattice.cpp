#include "core/bus/lattice.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::bus {
namespace {

constexpr double kLargest = 65535.0;
constexpr double kSmallestStep_m = 1e-6;  // finer than a float's resolution at the world's edge

}  // namespace

std::array<std::uint16_t, 3> Lattice::quantised(const Eigen::Vector3f& place) const {
    const auto code = [this](double offset_m) {
        return static_cast<std::uint16_t>(std::clamp(std::round(offset_m / step_m), 0.0, kLargest));
    };
    const Eigen::Vector3d offset = place.cast<double>() - origin_m;
    return {code(offset.x()), code(offset.y()), code(offset.z())};
}

Lattice lattice_around(std::span<const Eigen::Vector3f> places) {
    if (places.empty()) return {};
    Eigen::Vector3f low = places.front();
    Eigen::Vector3f high = places.front();
    for (const Eigen::Vector3f& place : places) {
        low = low.cwiseMin(place);
        high = high.cwiseMax(place);
    }
    Lattice lattice;
    lattice.origin_m = low.cast<double>();
    const double extent_m = (high.cast<double>() - lattice.origin_m).maxCoeff();
    lattice.step_m = std::max(kSmallestStep_m, extent_m / kLargest);
    return lattice;
}

}  // namespace atrium::bus
