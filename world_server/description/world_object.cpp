#include "world_server/description/world_object.hpp"

namespace atrium::world_server {
namespace {

physics::ObjectShape to_rigid(bus::Shape shape) {
    switch (shape) {
        case bus::Shape::kSphere:
            return physics::ObjectShape::kSphere;
        case bus::Shape::kCylinder:
            return physics::ObjectShape::kCylinder;
        case bus::Shape::kCapsule:
            return physics::ObjectShape::kCapsule;
        case bus::Shape::kPlane:
            return physics::ObjectShape::kPlane;
        case bus::Shape::kConvex:
            return physics::ObjectShape::kConvex;
        case bus::Shape::kCompound:
            return physics::ObjectShape::kCompound;
        case bus::Shape::kBox:
        case bus::Shape::kSoft:  // not a rigid object
            break;
    }
    return physics::ObjectShape::kBox;
}

}  // namespace

physics::RigidObject to_rigid(const WorldObject& object) {
    physics::ObjectShape shape = to_rigid(object.scene.shape);
    // a compound of one part is convex
    if (object.parts && object.parts->size() == 1) shape = physics::ObjectShape::kConvex;
    return {.id = object.scene.object,
            .shape = shape,
            .size_m = object.scene.size_m,
            .mass_kg = object.scene.mass_kg,
            .friction = object.scene.friction,
            .restitution = object.scene.restitution,
            .world_from_object = object.scene.world_from_object,
            .rolling_friction_m = object.rolling_friction_m,
            .drag_per_s = object.drag_per_s,
            .parts = object.parts};
}

}  // namespace atrium::world_server
