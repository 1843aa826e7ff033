#include "core/bus/limits.hpp"
#include "core/bus/wire_fields.hpp"

namespace atrium::bus {

void to_wire(const SoftBody& message, WireScratch& /*scratch*/, atrium_SoftBody& out) {
    key_to_wire(message, out);
    out.num_nodes = message.num_nodes;
    out.thickness_m = message.thickness_m;
    lend_groups(message.triangles, out.triangles);
    lend_groups(message.segments, out.segments);
}

Expected<SoftBody> from_wire(const atrium_SoftBody& wire) {
    auto triangles = groups_of<3>(wire.triangles, kMaxSoftTriangles, "SoftBody.triangles");
    if (!triangles) return tl::unexpected(triangles.error());
    auto segments = groups_of<2>(wire.segments, kMaxSoftSegments, "SoftBody.segments");
    if (!segments) return tl::unexpected(segments.error());
    return checked(SoftBody{wire.object,
                            wire.num_nodes,
                            wire.thickness_m,
                            std::move(*triangles),
                            std::move(*segments)});
}

void key_to_wire(const SoftBody& message, atrium_SoftBody& out) { out.object = message.object; }

Expected<SoftBody> key_from_wire(const atrium_SoftBody& wire) {
    SoftBody key;
    key.object = wire.object;
    return key;
}

std::size_t payload_bytes(const SoftBody& message) {
    return 2 * sizeof(std::uint32_t) + sizeof(double) +
           sizeof(std::uint16_t) * (3 * message.triangles.size() + 2 * message.segments.size());
}

void to_wire(const SoftBodyState& message, WireScratch& /*scratch*/, atrium_SoftBodyState& out) {
    key_to_wire(message, out);
    out.tick = message.tick;
    out.time_ns = message.time.ns;
    put_vector(message.origin_m, out.origin_m);
    out.step_m = message.step_m;
    lend_groups(message.nodes, out.nodes);
}

Expected<SoftBodyState> from_wire(const atrium_SoftBodyState& wire) {
    auto nodes = groups_of<3>(wire.nodes, kMaxSoftNodes, "SoftBodyState.nodes");
    if (!nodes) return tl::unexpected(nodes.error());
    return checked(SoftBodyState{wire.object,
                                 wire.tick,
                                 {wire.time_ns},
                                 get_vector(wire.origin_m),
                                 wire.step_m,
                                 std::move(*nodes)});
}

void key_to_wire(const SoftBodyState& message, atrium_SoftBodyState& out) {
    out.object = message.object;
}

Expected<SoftBodyState> key_from_wire(const atrium_SoftBodyState& wire) {
    SoftBodyState key;
    key.object = wire.object;
    return key;
}

std::size_t payload_bytes(const SoftBodyState& message) {
    return sizeof(std::uint32_t) + 2 * sizeof(std::int64_t) + kVectorBytes + sizeof(double) +
           3 * sizeof(std::uint16_t) * message.nodes.size();
}

void to_wire(const Scenery& message, WireScratch& /*scratch*/, atrium_Scenery& out) {
    key_to_wire(message, out);
    put_model_file(message.model, out.model);
    out.model_scale = message.model_scale;
    put_model_file(message.texture, out.texture);
    put_vector(message.colour, out.colour);
    put_pose(message.world_from_model, out.world_from_model);
}

Expected<Scenery> from_wire(const atrium_Scenery& wire) {
    auto result = checked(Scenery{get_name(wire.name),
                                  get_model_file(wire.model),
                                  wire.model_scale,
                                  get_model_file(wire.texture),
                                  get_vector(wire.colour),
                                  get_pose(wire.world_from_model)});
    if (result) normalise_rotation(result->world_from_model);
    return result;
}

void key_to_wire(const Scenery& message, atrium_Scenery& out) { put_name(message.name, out.name); }

Expected<Scenery> key_from_wire(const atrium_Scenery& wire) {
    Scenery key;
    key.name = get_name(wire.name);
    return with_checked_name(std::move(key), key.name);
}

std::size_t payload_bytes(const Scenery& message) {
    return message.name.size() + message.model.size() + message.texture.size() + sizeof(double) +
           kVectorBytes + kPoseBytes;
}

}  // namespace atrium::bus
