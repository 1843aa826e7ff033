#include "core/bus/limits.hpp"
#include "core/bus/wire_fields.hpp"

namespace atrium::bus {

namespace {

constexpr std::size_t kObjectStateBytes = sizeof(std::uint32_t) + kPoseBytes + 2 * kVectorBytes;

void put_object(const SceneObject& object, atrium_SceneObject& out) {
    out.object = object.object;
    put_name(object.name, out.name);
    out.shape = static_cast<std::uint8_t>(object.shape);
    put_vector(object.size_m, out.size_m);
    out.mass_kg = object.mass_kg;
    out.friction = object.friction;
    out.restitution = object.restitution;
    put_vector(object.colour, out.colour);
    put_model_file(object.model, out.model);
    out.model_scale = object.model_scale;
    put_model_file(object.texture, out.texture);
    put_pose(object.world_from_object, out.world_from_object);
}

SceneObject get_object(const atrium_SceneObject& wire) {
    SceneObject object;
    object.object = wire.object;
    object.name = get_name(wire.name);
    object.shape = static_cast<Shape>(wire.shape);  // any octet; `check` rejects unknown ones
    object.size_m = get_vector(wire.size_m);
    object.mass_kg = wire.mass_kg;
    object.friction = wire.friction;
    object.restitution = wire.restitution;
    object.colour = get_vector(wire.colour);
    object.model = get_model_file(wire.model);
    object.model_scale = wire.model_scale;
    object.texture = get_model_file(wire.texture);
    object.world_from_object = get_pose(wire.world_from_object);
    return object;
}

}  // namespace

void to_wire(const SitePlacement& message, WireScratch& /*scratch*/, atrium_SitePlacement& out) {
    key_to_wire(message, out);
    put_pose(message.world_from_site, out.world_from_site);
}

Expected<SitePlacement> from_wire(const atrium_SitePlacement& wire) {
    auto result = checked(SitePlacement{get_name(wire.site), get_pose(wire.world_from_site)});
    if (result) normalise_rotation(result->world_from_site);
    return result;
}

void key_to_wire(const SitePlacement& message, atrium_SitePlacement& out) {
    put_name(message.site, out.site);
}

Expected<SitePlacement> key_from_wire(const atrium_SitePlacement& wire) {
    SitePlacement key;
    key.site = get_name(wire.site);
    return with_checked_name(std::move(key), key.site);
}

std::size_t payload_bytes(const SitePlacement& message) { return message.site.size() + kPoseBytes; }

void to_wire(const SceneObject& message, WireScratch& /*scratch*/, atrium_SceneObject& out) {
    put_object(message, out);
}

Expected<SceneObject> from_wire(const atrium_SceneObject& wire) {
    auto result = checked(get_object(wire));
    if (result) normalise_rotation(result->world_from_object);
    return result;
}

void key_to_wire(const SceneObject& message, atrium_SceneObject& out) {
    out.object = message.object;
}

Expected<SceneObject> key_from_wire(const atrium_SceneObject& wire) {
    SceneObject key;
    key.object = wire.object;
    return key;
}

std::size_t payload_bytes(const SceneObject& message) {
    return sizeof(std::uint32_t) + message.name.size() + 1 + 2 * kVectorBytes + 4 * sizeof(double) +
           message.model.size() + message.texture.size() + kPoseBytes;
}

void to_wire(const SceneState& message, WireScratch& scratch, atrium_SceneState& out) {
    key_to_wire(message, out);
    out.tick = message.tick;
    out.time_ns = message.time.ns;
    scratch.objects.resize(message.objects.size());
    for (std::size_t i = 0; i < message.objects.size(); ++i) {
        const ObjectState& object = message.objects[i];
        atrium_ObjectState& wire = scratch.objects[i];
        wire.object = object.object;
        put_pose(object.world_from_object, wire.world_from_object);
        put_vector(object.linear_velocity, wire.linear_velocity);
        put_vector(object.angular_velocity, wire.angular_velocity);
    }
    lend(scratch.objects, out.objects);
}

Expected<SceneState> from_wire(const atrium_SceneState& wire) {
    if (wire.objects._length > kMaxObjects) return too_many("SceneState.objects");
    SceneState message;
    message.world = get_name(wire.world);
    message.tick = wire.tick;
    message.time.ns = wire.time_ns;
    message.objects.reserve(wire.objects._length);
    for (const atrium_ObjectState& object : elements_of(wire.objects)) {
        message.objects.push_back({object.object,
                                   get_pose(object.world_from_object),
                                   get_vector(object.linear_velocity),
                                   get_vector(object.angular_velocity)});
    }
    auto result = checked(std::move(message));
    if (result) {
        for (ObjectState& object : result->objects) normalise_rotation(object.world_from_object);
    }
    return result;
}

void key_to_wire(const SceneState& message, atrium_SceneState& out) {
    put_name(message.world, out.world);
}

Expected<SceneState> key_from_wire(const atrium_SceneState& wire) {
    SceneState key;
    key.world = get_name(wire.world);
    return with_checked_name(std::move(key), key.world);
}

std::size_t payload_bytes(const SceneState& message) {
    return message.world.size() + 2 * sizeof(std::int64_t) +
           message.objects.size() * kObjectStateBytes;
}

void to_wire(const SceneCommand& message, WireScratch& /*scratch*/, atrium_SceneCommand& out) {
    key_to_wire(message, out);
    out.kind = static_cast<std::uint8_t>(message.kind);
    out.target = message.target;
    put_vector(message.impulse_ns, out.impulse_ns);
    put_vector(message.point_object, out.point_object);
    put_vector(message.goal_world, out.goal_world);
    put_object(message.object, out.object);
}

Expected<SceneCommand> from_wire(const atrium_SceneCommand& wire) {
    SceneCommand message;
    message.sender = get_name(wire.sender);
    message.kind = static_cast<CommandKind>(wire.kind);
    message.target = wire.target;
    message.impulse_ns = get_vector(wire.impulse_ns);
    message.point_object = get_vector(wire.point_object);
    message.goal_world = get_vector(wire.goal_world);
    // The other kinds ignore `object`: do not even read it.
    if (message.kind == CommandKind::kAdd) message.object = get_object(wire.object);
    auto result = checked(std::move(message));
    if (result) normalise_rotation(result->object.world_from_object);
    return result;
}

void key_to_wire(const SceneCommand& message, atrium_SceneCommand& out) {
    put_name(message.sender, out.sender);
}

Expected<SceneCommand> key_from_wire(const atrium_SceneCommand& wire) {
    SceneCommand key;
    key.sender = get_name(wire.sender);
    return with_checked_name(std::move(key), key.sender);
}

std::size_t payload_bytes(const SceneCommand& message) {
    return message.sender.size() + 1 + sizeof(std::uint32_t) + 3 * kVectorBytes +
           payload_bytes(message.object);
}

}  // namespace atrium::bus
