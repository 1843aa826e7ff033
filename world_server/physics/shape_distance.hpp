#pragma once

#include <LinearMath/btVector3.h>

#include <optional>

class btCollisionShape;

namespace atrium::physics {

struct ShapePoint {
    btScalar distance = 0;  // [m] < 0: inside
    btVector3 normal;       // unit length, outwards, of the shape's frame
};

/// How far `point`, in the shape's frame, is from the shape's surface: exact for spheres, boxes,
/// capsules, cylinders along z and planes, by Bullet's GJK for other convex shapes, and the least
/// of all parts for compounds. Nothing for other shapes, and nothing where it would be more than
/// `reach_m` away, as far as that is cheap to see.
std::optional<ShapePoint> distance_to_shape(const btCollisionShape& shape,
                                            const btVector3& point,
                                            btScalar reach_m);

}  // namespace atrium::physics
