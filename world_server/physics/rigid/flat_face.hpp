#pragma once

#include "world_server/physics/options/rigid_options.hpp"

#include <btBulletCollisionCommon.h>

#include <array>
#include <optional>

namespace atrium::physics {

struct FlatPoint {
    btVector3 on_face{0, 0, 0};  // in the world
    btScalar gap = 0;            // from the face to the cylinder's end; negative inside
};

struct FlatTouch {
    btVector3 normal{0, 0, 0};  // of the face, towards the cylinder
    std::array<FlatPoint, 4> points;
};

/// Finds the points where an end of a cylinder lies on a flat face of a cylinder, box, hull or
/// plane. They span the area that both share. None if no end lies flat within `reach_m` of a face.
std::optional<FlatTouch> find_flat_touch(const btCylinderShapeZ& cylinder,
                                         const btTransform& world_from_cylinder,
                                         const btCollisionShape& other,
                                         const btTransform& world_from_other,
                                         btScalar reach_m,
                                         const FlatContactOptions& options);

}  // namespace atrium::physics
