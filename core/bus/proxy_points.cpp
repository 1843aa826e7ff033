#include "core/bus/proxy_points.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::bus {
namespace {

std::array<std::int16_t, 3> quantised(const Eigen::Vector3f& vector, float per_unit) {
    const auto code = [per_unit](float component) {
        return static_cast<std::int16_t>(
            std::lround(std::clamp(component * per_unit, -32767.0F, 32767.0F)));
    };
    return {code(vector.x()), code(vector.y()), code(vector.z())};
}

}  // namespace

ProxyPoint make_proxy_point(const Lattice& lattice,
                            const Eigen::Vector3f& p_world,
                            const Eigen::Vector3f& velocity_mps,
                            const Eigen::Vector3f& normal) {
    return {
        lattice.quantised(p_world), quantised(velocity_mps, 1000.0F), quantised(normal, 32767.0F)};
}

}  // namespace atrium::bus
