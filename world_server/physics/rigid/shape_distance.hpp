#pragma once

#include <LinearMath/btVector3.h>

#include <optional>

class btCollisionShape;

namespace atrium::physics {

struct ShapePoint {
    btScalar distance = 0;  // signed [m]; < 0: inside
    btVector3 normal;       // unit length, outward, in the shape's frame
};

/// Computes the signed distance from `point` (shape frame) to the shape's surface.
///
/// Exact for spheres, boxes, capsules, cylinders along z and planes. Uses Bullet's GJK for other
/// convex shapes and the smallest distance of all parts for compounds. Empty for all other shapes,
/// and where a cheap test shows that the distance exceeds `reach_m`.
std::optional<ShapePoint> distance_to_shape(const btCollisionShape& shape,
                                            const btVector3& point,
                                            btScalar reach_m);

}  // namespace atrium::physics
