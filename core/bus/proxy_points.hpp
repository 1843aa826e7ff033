#pragma once

#include "core/bus/lattice.hpp"
#include "core/bus/messages.hpp"

#include <Eigen/Core>

#include <cstddef>

/// What the numbers of proxies say, in metres and metres per second.
namespace atrium::bus {

/// `velocity_mps` is brought below 32.767 m/s on each axis; `normal` has unit length.
ProxyPoint make_proxy_point(const Lattice& lattice,
                            const Eigen::Vector3f& p_world,
                            const Eigen::Vector3f& velocity_mps,
                            const Eigen::Vector3f& normal);

/// [m] world.
inline Eigen::Vector3d place_of(const PersonProxy& proxy, std::size_t point) {
    const auto& [x, y, z] = proxy.points[point].place;
    return proxy.origin_m + proxy.step_m * Eigen::Vector3d(x, y, z);
}

/// [m/s] world.
inline Eigen::Vector3d velocity_of(const ProxyPoint& point) {
    const auto& [x, y, z] = point.velocity_mmps;
    return 1e-3 * Eigen::Vector3d(x, y, z);
}

/// Of unit length where its sender kept to the rules.
inline Eigen::Vector3d normal_of(const ProxyPoint& point) {
    const auto& [x, y, z] = point.normal;
    return Eigen::Vector3d(x, y, z) / 32767.0;
}

/// [m] in the object's frame.
inline Eigen::Vector3d vertex_of(const ObjectProxy& proxy, std::size_t vertex) {
    const auto& [x, y, z] = proxy.vertices[vertex];
    return proxy.origin_m + proxy.step_m * Eigen::Vector3d(x, y, z);
}

}  // namespace atrium::bus
