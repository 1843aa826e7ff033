#include "world_server/scene_messages.hpp"

namespace atrium::world_server {
namespace {

using physics::ObjectShape;

// Both enumerations list the rigid shapes in the same order.
constexpr bool is_same(bus::Shape a, ObjectShape b) {
    return static_cast<int>(a) == static_cast<int>(b);
}
static_assert(is_same(bus::Shape::kBox, ObjectShape::kBox));
static_assert(is_same(bus::Shape::kSphere, ObjectShape::kSphere));
static_assert(is_same(bus::Shape::kCylinder, ObjectShape::kCylinder));
static_assert(is_same(bus::Shape::kCapsule, ObjectShape::kCapsule));
static_assert(is_same(bus::Shape::kPlane, ObjectShape::kPlane));
static_assert(is_same(bus::Shape::kConvex, ObjectShape::kConvex));
static_assert(is_same(bus::Shape::kCompound, ObjectShape::kCompound));

}  // namespace

bus::SceneObject to_message(const WorldObject& object) {
    return {.object = object.rigid.id,
            .name = object.name,
            .shape = static_cast<bus::Shape>(object.rigid.shape),
            .size_m = object.rigid.size_m,
            .mass_kg = object.rigid.mass_kg,
            .friction = object.rigid.friction,
            .restitution = object.rigid.restitution,
            .colour = object.look.colour,
            .model = object.look.model,
            .model_scale = object.look.model_scale,
            .texture = object.look.texture,
            .model_fingerprint = object.look.model_fingerprint,
            .texture_fingerprint = object.look.texture_fingerprint,
            .world_from_object = object.rigid.world_from_object};
}

bus::SceneObject to_message(const WorldSoftObject& object, const Eigen::Vector3d& size_m) {
    bus::SceneObject message;
    message.object = object.object.id;
    message.name = object.name;
    message.shape = bus::Shape::kSoft;
    message.size_m = size_m;
    message.mass_kg = object.object.mass_kg;
    message.friction = object.object.friction;
    message.colour = object.colour;
    message.texture = object.texture;
    message.texture_fingerprint = object.texture_fingerprint;
    message.world_from_object = object.object.world_from_object;
    return message;
}

bus::Scenery to_message(const WorldScenery& scenery) {
    return {.name = scenery.name,
            .model = scenery.look.model,
            .model_scale = scenery.look.model_scale,
            .texture = scenery.look.texture,
            .model_fingerprint = scenery.look.model_fingerprint,
            .texture_fingerprint = scenery.look.texture_fingerprint,
            .colour = scenery.look.colour,
            .world_from_model = scenery.world_from_model};
}

physics::RigidObject to_rigid(const bus::SceneObject& object) {
    return {.id = object.object,
            .shape = static_cast<ObjectShape>(object.shape),
            .size_m = object.size_m,
            .mass_kg = object.mass_kg,
            .friction = object.friction,
            .restitution = object.restitution,
            .world_from_object = object.world_from_object};
}

}  // namespace atrium::world_server
