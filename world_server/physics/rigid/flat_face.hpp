#pragma once

#include "world_server/physics/options/rigid_options.hpp"
#include "world_server/physics/rigid/flat_area.hpp"

#include <btBulletCollisionCommon.h>

#include <optional>

namespace atrium::physics {

/// A flat face of a shape. The normal points out of the shape. An infinite face has no outline.
struct FlatFace {
    PlaneFrame frame;
    std::optional<Polygon> outline;  // counter-clockwise, in the axes of `frame`
};

/// Finds the face of a cylinder, box or hull that looks most along `towards`, a unit vector. None
/// if a hull is not flat there, and for any other shape.
std::optional<FlatFace> find_face(const btCollisionShape& shape,
                                  const btTransform& world_from_shape,
                                  const btVector3& towards,
                                  const FlatContactOptions& options);

/// Whether `end` faces `face` and is tilted no more than `options.max_tilt`.
bool lies_flat(const FlatFace& face, const FlatFace& end, const FlatContactOptions& options);

/// Finds the points where an end of a cylinder lies on a flat face of a cylinder, box, hull or
/// plane. They span the area that both share. None if no end lies flat within `reach_m` of a face.
std::optional<FlatTouch> find_flat_touch(const btCylinderShapeZ& cylinder,
                                         const btTransform& world_from_cylinder,
                                         const btCollisionShape& other,
                                         const btTransform& world_from_other,
                                         btScalar reach_m,
                                         const FlatContactOptions& options);

}  // namespace atrium::physics
