#include "world_server/physics/rigid/flat_face.hpp"

#include <cmath>

namespace atrium::physics {
namespace {

// Radius of a cylinder's flat end: without the rounded edge, as Bullet sees it.
btScalar end_radius(const btCylinderShapeZ& cylinder) {
    return cylinder.getHalfExtentsWithoutMargin().x();
}

// The face of each shape that looks most along `towards`.
FlatFace end_of(const btCylinderShapeZ& cylinder,
                const btTransform& pose,
                const btVector3& towards) {
    const btVector3 axis = pose.getBasis().getColumn(2);
    const btVector3 normal = axis.dot(towards) >= 0 ? axis : -axis;
    const btVector3 centre = pose.getOrigin() + cylinder.getHalfExtentsWithMargin().z() * normal;
    return {{centre, normal, pose.getBasis().getColumn(0)}, circle({}, end_radius(cylinder))};
}

FlatFace side_of(const btBoxShape& box, const btTransform& pose, const btVector3& towards) {
    const btVector3 local = towards * pose.getBasis();
    const int axis = local.absolute().maxAxis();
    const btVector3 half = box.getHalfExtentsWithMargin();
    const btVector3 normal = pose.getBasis().getColumn(axis) * (local[axis] >= 0 ? 1 : -1);
    const int along = (axis + 1) % 3;
    const btScalar half_u = half[along];
    const btScalar half_v = half[(axis + 2) % 3];
    Polygon outline;
    for (const Corner& c : {Corner{1, 1}, Corner{-1, 1}, Corner{-1, -1}, Corner{1, -1}})
        outline.add({c.u * half_u, c.v * half_v});
    return {{pose.getOrigin() + half[axis] * normal, normal, pose.getBasis().getColumn(along)},
            outline};
}

std::optional<FlatFace> face_of(const btConvexHullShape& hull,
                                const btTransform& pose,
                                const btVector3& towards,
                                const FlatContactOptions& options) {
    const btVector3 local = towards * pose.getBasis();
    const PlaneFrame search(
        btVector3(0, 0, 0),
        local,
        std::abs(local.x()) < btScalar(0.7) ? btVector3(1, 0, 0) : btVector3(0, 1, 0));
    std::array<btVector3, kNumRim> found;
    std::size_t num_found = 0;
    const Polygon around = circle({}, options.hull_search_tilt);
    for (std::size_t i = 0; i < around.size; ++i) {
        const Corner& c = around.corners[i];
        const btVector3 p =
            hull.localGetSupportingVertexWithoutMargin(local + c.u * search.u + c.v * search.v);
        if (num_found == 0 || (p - found[num_found - 1]).length2() > 0) found[num_found++] = p;
    }
    if (num_found > 1 && (found[0] - found[num_found - 1]).length2() <= 0) --num_found;
    btVector3 normal(0, 0, 0);
    for (std::size_t i = 2; i < num_found; ++i)
        normal += (found[i - 1] - found[0]).cross(found[i] - found[0]);
    if (num_found < 3 || normal.fuzzyZero()) return std::nullopt;
    normal.normalize();
    const btVector3 edge = found[1] - found[0];
    const PlaneFrame frame(found[0], normal, edge);
    Polygon outline;
    for (std::size_t i = 0; i < num_found; ++i) {
        if (std::abs(normal.dot(found[i] - found[0])) > options.hull_uneven_m) return std::nullopt;
        outline.add(frame.flat(found[i]));
    }
    return FlatFace{{pose * (found[0] + hull.getMargin() * normal),
                     pose.getBasis() * normal,
                     pose.getBasis() * edge},
                    outline};
}

}  // namespace

std::optional<FlatFace> find_face(const btCollisionShape& shape,
                                  const btTransform& pose,
                                  const btVector3& towards,
                                  const FlatContactOptions& options) {
    switch (shape.getShapeType()) {
        case CYLINDER_SHAPE_PROXYTYPE:
            return end_of(static_cast<const btCylinderShapeZ&>(shape), pose, towards);
        case BOX_SHAPE_PROXYTYPE:
            return side_of(static_cast<const btBoxShape&>(shape), pose, towards);
        case CONVEX_HULL_SHAPE_PROXYTYPE:
            return face_of(static_cast<const btConvexHullShape&>(shape), pose, towards, options);
        default:
            return std::nullopt;
    }
}

bool lies_flat(const FlatFace& face, const FlatFace& end, const FlatContactOptions& options) {
    const btVector3& normal = end.frame.normal;
    return face.frame.normal.dot(normal) < 0 &&
           face.frame.normal.cross(normal).length() <= options.max_tilt;
}

namespace {

FlatFace plane_of(const btStaticPlaneShape& plane,
                  const btTransform& pose,
                  const btVector3& near_u) {
    const btVector3 normal = pose.getBasis() * plane.getPlaneNormal();
    return {{pose * (plane.getPlaneConstant() * plane.getPlaneNormal()), normal, near_u}, {}};
}

btVector3 centre_of(const btCollisionShape& shape, const btTransform& pose) {
    btVector3 low;
    btVector3 high;
    shape.getAabb(pose, low, high);
    return (low + high) / 2;
}

}  // namespace

std::optional<FlatTouch> find_flat_touch(const btCylinderShapeZ& cylinder,
                                         const btTransform& world_from_cylinder,
                                         const btCollisionShape& other,
                                         const btTransform& world_from_other,
                                         btScalar reach_m,
                                         const FlatContactOptions& options) {
    const bool is_plane = other.getShapeType() == STATIC_PLANE_PROXYTYPE;
    std::optional<FlatFace> face;
    btVector3 towards = centre_of(other, world_from_other) - world_from_cylinder.getOrigin();
    if (is_plane) {
        face = plane_of(static_cast<const btStaticPlaneShape&>(other),
                        world_from_other,
                        world_from_cylinder.getBasis().getColumn(0));
        towards = -face->frame.normal;
    }
    const FlatFace end = end_of(cylinder, world_from_cylinder, towards);
    if (!is_plane) face = find_face(other, world_from_other, -end.frame.normal, options);
    if (!face) return std::nullopt;
    if (!lies_flat(*face, end, options)) return std::nullopt;
    FlatArea area(face->frame, end.frame);
    const Polygon rim = circle(face->frame.flat(end.frame.origin), end_radius(cylinder));
    area.add(face->outline ? shared_area(rim, *face->outline) : rim);
    return area.touch(reach_m, /*min_width_m=*/0, options);
}

}  // namespace atrium::physics
