#pragma once

#include "core/bus/lattice.hpp"
#include "core/bus/messages.hpp"

#include <Eigen/Core>

#include <cstddef>

/// Converts the quantised values of proxies to and from metres and metres per second.
namespace atrium::bus {

/// Quantises a point. `velocity_mps` is clamped to 32.767 m/s on each axis; `normal` has unit
/// length.
ProxyPoint make_proxy_point(const Lattice& lattice,
                            const Eigen::Vector3f& p_world,
                            const Eigen::Vector3f& velocity_mps,
                            const Eigen::Vector3f& normal);

/// Place of a point [m] in the world.
inline Eigen::Vector3d place_of(const PersonProxy& proxy, std::size_t point) {
    const auto& [x, y, z] = proxy.points[point].place;
    return proxy.origin_m + proxy.step_m * Eigen::Vector3d(x, y, z);
}

/// Velocity of a point [m/s] in the world.
inline Eigen::Vector3d velocity_of(const ProxyPoint& point) {
    const auto& [x, y, z] = point.velocity_mmps;
    return 1e-3 * Eigen::Vector3d(x, y, z);
}

/// Outward normal in the world. Its length is 1 only if the sender obeyed the contract.
inline Eigen::Vector3d normal_of(const ProxyPoint& point) {
    const auto& [x, y, z] = point.normal;
    return Eigen::Vector3d(x, y, z) / 32767.0;
}

/// Place of a vertex [m] in the object's frame.
inline Eigen::Vector3d vertex_of(const ObjectProxy& proxy, std::size_t vertex) {
    const auto& [x, y, z] = proxy.vertices[vertex];
    return proxy.origin_m + proxy.step_m * Eigen::Vector3d(x, y, z);
}

}  // namespace atrium::bus
