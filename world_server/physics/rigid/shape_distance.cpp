#include "world_server/physics/rigid/shape_distance.hpp"

#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>
#include <btBulletCollisionCommon.h>

#include <algorithm>
#include <cmath>

namespace atrium::physics {
namespace {

ShapePoint from_centre(const btVector3& offset, btScalar radius) {
    const btScalar length = offset.length();
    const btVector3 up(0, 0, 1);  // any direction is correct at the centre
    return {length - radius, length > btScalar(1e-6) ? offset / length : up};
}

ShapePoint from_box(const btVector3& half, const btVector3& p) {
    const btVector3 q = p.absolute() - half;
    btVector3 sign;
    for (int i = 0; i < 3; ++i) sign[i] = p[i] < 0 ? btScalar(-1) : btScalar(1);
    if (q.x() <= 0 && q.y() <= 0 && q.z() <= 0) {
        const int axis = q.maxAxis();
        btVector3 normal(0, 0, 0);
        normal[axis] = sign[axis];
        return {q[axis], normal};
    }
    btVector3 out = q;
    out.setMax(btVector3(0, 0, 0));
    const btScalar length = out.length();
    return {length, out * sign / length};
}

// Treats the cylinder as a box in (distance from the axis, z).
ShapePoint from_cylinder(btScalar radius, btScalar half_height, const btVector3& p) {
    const btScalar around = std::hypot(p.x(), p.y());
    const btVector3 radial =
        around > btScalar(1e-6) ? btVector3(p.x(), p.y(), 0) / around : btVector3(1, 0, 0);
    // y must not matter: make the box thick along y
    const ShapePoint flat =
        from_box(btVector3(radius, radius + half_height, half_height), btVector3(around, 0, p.z()));
    return {flat.distance, radial * flat.normal.x() + btVector3(0, 0, flat.normal.z())};
}

std::optional<ShapePoint> from_compound(const btCompoundShape& shape,
                                        const btVector3& point,
                                        btScalar reach_m) {
    std::optional<ShapePoint> best;
    for (int i = 0; i < shape.getNumChildShapes(); ++i) {
        const btTransform& part = shape.getChildTransform(i);
        const auto found =
            distance_to_shape(*shape.getChildShape(i), part.invXform(point), reach_m);
        if (!found || (best && found->distance >= best->distance)) continue;
        best = ShapePoint{found->distance, part.getBasis() * found->normal};
    }
    return best;
}

std::optional<ShapePoint> from_convex(const btConvexShape& shape,
                                      const btVector3& point,
                                      btScalar reach_m) {
    btVector3 low, high;
    shape.getAabb(btTransform::getIdentity(), low, high);
    for (int i = 0; i < 3; ++i) {
        if (point[i] < low[i] - reach_m || point[i] > high[i] + reach_m) return std::nullopt;
    }
    btGjkEpaSolver2::sResults results;
    const btScalar distance = btGjkEpaSolver2::SignedDistance(
        point, /*margin=*/btScalar(0), &shape, btTransform::getIdentity(), results);
    // without convergence it returns a huge number
    if (!(std::abs(distance) < btScalar(100)) || results.normal.length2() < btScalar(0.25)) {
        return std::nullopt;
    }
    return ShapePoint{distance, results.normal.normalized()};
}

}  // namespace

std::optional<ShapePoint> distance_to_shape(const btCollisionShape& shape,
                                            const btVector3& point,
                                            btScalar reach_m) {
    switch (shape.getShapeType()) {
        case SPHERE_SHAPE_PROXYTYPE:
            return from_centre(point, static_cast<const btSphereShape&>(shape).getRadius());
        case BOX_SHAPE_PROXYTYPE:
            return from_box(static_cast<const btBoxShape&>(shape).getHalfExtentsWithMargin(),
                            point);
        case CAPSULE_SHAPE_PROXYTYPE: {
            const auto& capsule = static_cast<const btCapsuleShape&>(shape);
            btVector3 offset = point;
            const int axis = capsule.getUpAxis();
            const btScalar half = capsule.getHalfHeight();
            offset[axis] -= std::clamp(offset[axis], -half, half);
            return from_centre(offset, capsule.getRadius());
        }
        case CYLINDER_SHAPE_PROXYTYPE: {
            const auto& cylinder = static_cast<const btCylinderShape&>(shape);
            if (cylinder.getUpAxis() != 2) break;
            const btVector3 half = cylinder.getHalfExtentsWithMargin();
            return from_cylinder(half.x(), half.z(), point);
        }
        case STATIC_PLANE_PROXYTYPE: {
            const auto& plane = static_cast<const btStaticPlaneShape&>(shape);
            const btVector3& normal = plane.getPlaneNormal();
            return ShapePoint{normal.dot(point) - plane.getPlaneConstant(), normal};
        }
        case COMPOUND_SHAPE_PROXYTYPE:
            return from_compound(static_cast<const btCompoundShape&>(shape), point, reach_m);
        default:
            break;
    }
    if (!shape.isConvex()) return std::nullopt;
    return from_convex(static_cast<const btConvexShape&>(shape), point, reach_m);
}

}  // namespace atrium::physics
