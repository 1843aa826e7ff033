#include "world_server/proxies.hpp"

#include "core/bus/limits.hpp"
#include "core/bus/proxy_points.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace atrium::world_server {
namespace {

constexpr double kSamePlane = 0.9999;  // cosine; less than a degree apart

using Edge = std::array<std::uint16_t, 2>;

// Returns the edges at which the part's surface bends.
std::vector<Edge> sharp_edges(const geometry::TriangleMesh& part) {
    std::map<Edge, std::vector<Eigen::Vector3d>> normals;  // normals of the triangles at each edge
    for (const auto& triangle : part.triangles) {
        const Eigen::Vector3d& a = part.vertices[triangle[0]];
        const Eigen::Vector3d normal =
            (part.vertices[triangle[1]] - a).cross(part.vertices[triangle[2]] - a).normalized();
        for (std::size_t i = 0; i < 3; ++i) {
            const auto from = static_cast<std::uint16_t>(triangle[i]);
            const auto to = static_cast<std::uint16_t>(triangle[(i + 1) % 3]);
            normals[{std::min(from, to), std::max(from, to)}].push_back(normal);
        }
    }
    std::vector<Edge> edges;
    for (const auto& [edge, beside] : normals) {
        if (beside.size() != 2 || beside[0].dot(beside[1]) < kSamePlane) edges.push_back(edge);
    }
    return edges;
}

}  // namespace

void fill_proxy(const physics::PersonSnapshot& person,
                std::vector<Eigen::Vector3f>& places,
                bus::PersonProxy& proxy) {
    const std::vector<physics::MovingSurfel>& surfels = *person.surfels;
    const std::size_t step = std::max<std::size_t>(
        1, (surfels.size() + bus::kMaxProxyPoints - 1) / bus::kMaxProxyPoints);
    places.clear();
    for (std::size_t i = 0; i < surfels.size(); i += step) {
        const physics::MovingSurfel& surfel = surfels[i];
        places.push_back(surfel.position + person.share_to_go * (surfel.from - surfel.position));
    }
    const bus::Lattice lattice = bus::lattice_around(places);
    proxy.site = person.name;
    proxy.capture_time = person.capture_time;
    proxy.num_surfels = static_cast<std::uint32_t>(surfels.size());
    proxy.origin_m = lattice.origin_m;
    proxy.step_m = lattice.step_m;
    proxy.points.clear();
    for (std::size_t i = 0; i < places.size(); ++i) {
        const physics::MovingSurfel& surfel = surfels[i * step];
        proxy.points.push_back(
            bus::make_proxy_point(lattice, places[i], surfel.velocity, surfel.normal));
    }
    proxy.touches.clear();
    for (const auto& touch : person.touches) {
        if (proxy.touches.size() == bus::kMaxTouches) break;
        proxy.touches.push_back({touch.object, touch.point.cast<double>()});
    }
}

bus::ObjectProxy make_object_proxy(std::uint32_t object,
                                   const std::vector<geometry::TriangleMesh>& parts) {
    std::vector<Eigen::Vector3f> vertices;
    bus::ObjectProxy proxy;
    proxy.object = object;
    for (const geometry::TriangleMesh& part : parts) {
        const std::vector<Edge> edges = sharp_edges(part);
        if (vertices.size() + part.vertices.size() > bus::kMaxProxyVertices ||
            proxy.edges.size() + edges.size() > bus::kMaxProxyEdges)
            break;
        const auto first = static_cast<std::uint16_t>(vertices.size());
        for (const Eigen::Vector3d& v : part.vertices) vertices.push_back(v.cast<float>());
        for (const auto& [from, to] : edges)
            proxy.edges.push_back(
                {static_cast<std::uint16_t>(first + from), static_cast<std::uint16_t>(first + to)});
    }
    const bus::Lattice lattice = bus::lattice_around(vertices);
    proxy.origin_m = lattice.origin_m;
    proxy.step_m = lattice.step_m;
    for (const Eigen::Vector3f& v : vertices) proxy.vertices.push_back(lattice.quantised(v));
    return proxy;
}

}  // namespace atrium::world_server
