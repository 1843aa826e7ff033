#include "core/bus/soft_nodes.hpp"

#include "core/bus/limits.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace atrium::bus {
namespace {

constexpr double kLargest = 65535.0;
constexpr double kSmallestStep_m = 1e-6;  // finer than what a float tells at the world's edge

}  // namespace

void quantise(std::span<const Eigen::Vector3f> places, SoftBodyState& out) {
    assert(places.size() <= kMaxSoftNodes);
    out.nodes.clear();
    if (places.empty()) return;
    Eigen::Vector3f low = places.front();
    Eigen::Vector3f high = places.front();
    for (const Eigen::Vector3f& place : places) {
        low = low.cwiseMin(place);
        high = high.cwiseMax(place);
    }
    out.origin_m = low.cast<double>();
    const double extent_m = (high.cast<double>() - out.origin_m).maxCoeff();
    out.step_m = std::max(kSmallestStep_m, extent_m / kLargest);
    const auto coded = [&](double offset_m) {
        return static_cast<std::uint16_t>(
            std::clamp(std::round(offset_m / out.step_m), 0.0, kLargest));
    };
    for (const Eigen::Vector3f& place : places) {
        const Eigen::Vector3d offset = place.cast<double>() - out.origin_m;
        out.nodes.push_back({coded(offset.x()), coded(offset.y()), coded(offset.z())});
    }
}

}  // namespace atrium::bus
