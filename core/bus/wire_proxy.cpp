#include "core/bus/limits.hpp"
#include "core/bus/wire_fields.hpp"

namespace atrium::bus {

void to_wire(const PersonProxy& message, WireScratch& scratch, atrium_PersonProxy& out) {
    key_to_wire(message, out);
    out.capture_time_ns = message.capture_time.ns;
    out.num_surfels = message.num_surfels;
    put_vector(message.origin_m, out.origin_m);
    out.step_m = message.step_m;
    scratch.proxy_points.resize(message.points.size());
    for (std::size_t i = 0; i < message.points.size(); ++i) {
        const ProxyPoint& point = message.points[i];
        atrium_ProxyPoint& wire = scratch.proxy_points[i];
        std::copy_n(point.place.data(), 3, wire.place);
        std::copy_n(point.velocity_mmps.data(), 3, wire.velocity_mmps);
        std::copy_n(point.normal.data(), 3, wire.normal);
    }
    lend(scratch.proxy_points, out.points);
    scratch.touches.resize(message.touches.size());
    for (std::size_t i = 0; i < message.touches.size(); ++i) {
        scratch.touches[i].object = message.touches[i].object;
        put_vector(message.touches[i].point_world, scratch.touches[i].point_world);
    }
    lend(scratch.touches, out.touches);
}

Expected<PersonProxy> from_wire(const atrium_PersonProxy& wire) {
    if (wire.points._length > kMaxProxyPoints) return too_many("PersonProxy.points");
    if (wire.touches._length > kMaxTouches) return too_many("PersonProxy.touches");
    PersonProxy message{get_name(wire.site),
                        {wire.capture_time_ns},
                        wire.num_surfels,
                        get_vector(wire.origin_m),
                        wire.step_m,
                        {},
                        {}};
    message.points.reserve(wire.points._length);
    for (const atrium_ProxyPoint& point : elements_of(wire.points)) {
        ProxyPoint& out = message.points.emplace_back();
        std::copy_n(point.place, 3, out.place.data());
        std::copy_n(point.velocity_mmps, 3, out.velocity_mmps.data());
        std::copy_n(point.normal, 3, out.normal.data());
    }
    message.touches.reserve(wire.touches._length);
    for (const atrium_Touch& touch : elements_of(wire.touches))
        message.touches.push_back({touch.object, get_vector(touch.point_world)});
    return checked(std::move(message));
}

void key_to_wire(const PersonProxy& message, atrium_PersonProxy& out) {
    put_name(message.site, out.site);
}

Expected<PersonProxy> key_from_wire(const atrium_PersonProxy& wire) {
    PersonProxy key;
    key.site = get_name(wire.site);
    return with_checked_name(std::move(key), key.site);
}

std::size_t payload_bytes(const PersonProxy& message) {
    return message.site.size() + sizeof(std::int64_t) + sizeof(std::uint32_t) + kVectorBytes +
           sizeof(double) + 9 * sizeof(std::uint16_t) * message.points.size() +
           (sizeof(std::uint32_t) + kVectorBytes) * message.touches.size();
}

void to_wire(const ObjectProxy& message, WireScratch& /*scratch*/, atrium_ObjectProxy& out) {
    key_to_wire(message, out);
    put_vector(message.origin_m, out.origin_m);
    out.step_m = message.step_m;
    lend_groups(message.vertices, out.vertices);
    lend_groups(message.edges, out.edges);
}

Expected<ObjectProxy> from_wire(const atrium_ObjectProxy& wire) {
    auto vertices = groups_of<3>(wire.vertices, kMaxProxyVertices, "ObjectProxy.vertices");
    if (!vertices) return tl::unexpected(vertices.error());
    auto edges = groups_of<2>(wire.edges, kMaxProxyEdges, "ObjectProxy.edges");
    if (!edges) return tl::unexpected(edges.error());
    return checked(ObjectProxy{wire.object,
                               get_vector(wire.origin_m),
                               wire.step_m,
                               std::move(*vertices),
                               std::move(*edges)});
}

void key_to_wire(const ObjectProxy& message, atrium_ObjectProxy& out) {
    out.object = message.object;
}

Expected<ObjectProxy> key_from_wire(const atrium_ObjectProxy& wire) {
    ObjectProxy key;
    key.object = wire.object;
    return key;
}

std::size_t payload_bytes(const ObjectProxy& message) {
    return sizeof(std::uint32_t) + kVectorBytes + sizeof(double) +
           sizeof(std::uint16_t) * (3 * message.vertices.size() + 2 * message.edges.size());
}

}  // namespace atrium::bus
