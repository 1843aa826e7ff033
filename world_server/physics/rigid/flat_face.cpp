#include "world_server/physics/rigid/flat_face.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace atrium::physics {
namespace {

constexpr std::size_t kNumRim = 16;  // corners that stand for a circle
constexpr btScalar kNoAreaM2 = btScalar(1e-8);
constexpr std::size_t kMaxCorners = 40;  // each edge of the other polygon adds at most one

struct Corner {
    btScalar u = 0;
    btScalar v = 0;
};

// A convex polygon in a plane, counter-clockwise.
struct Polygon {
    std::array<Corner, kMaxCorners> corners;
    std::size_t size = 0;

    void add(const Corner& corner) {
        if (size < corners.size()) corners[size++] = corner;
    }
};

// Axes of a plane.
struct PlaneFrame {
    PlaneFrame(const btVector3& origin_, const btVector3& normal_, const btVector3& near_u)
        : origin(origin_), normal(normal_) {
        u = (near_u - normal * normal.dot(near_u)).normalized();
        v = normal.cross(u);
    }
    Corner flat(const btVector3& p) const { return {u.dot(p - origin), v.dot(p - origin)}; }
    btVector3 at(const Corner& c) const { return origin + c.u * u + c.v * v; }

    btVector3 origin;
    btVector3 normal;
    btVector3 u;
    btVector3 v;
};

// A flat face. An infinite one has no outline.
struct Face {
    PlaneFrame frame;
    std::optional<Polygon> outline;
};

// Has corners at the diagonals of the axes, where the points of contact are sought.
Polygon circle(const Corner& centre, btScalar radius) {
    static const std::array<Corner, kNumRim> directions = [] {
        std::array<Corner, kNumRim> all;
        for (std::size_t i = 0; i < kNumRim; ++i) {
            const double angle = (0.25 + 2.0 * static_cast<double>(i) / kNumRim) * std::numbers::pi;
            all[i] = {btScalar(std::cos(angle)), btScalar(std::sin(angle))};
        }
        return all;
    }();
    Polygon rim;
    for (const Corner& d : directions) rim.add({centre.u + radius * d.u, centre.v + radius * d.v});
    return rim;
}

// Cuts away the part to the right of the edge.
void cut(Polygon& polygon, const Corner& from, const Corner& to) {
    std::array<btScalar, kMaxCorners> left;  // twice the area of the corner with the edge
    bool is_all_left = true;
    for (std::size_t i = 0; i < polygon.size; ++i) {
        const Corner& c = polygon.corners[i];
        left[i] = (to.u - from.u) * (c.v - from.v) - (to.v - from.v) * (c.u - from.u);
        is_all_left = is_all_left && left[i] >= -kNoAreaM2;
    }
    if (is_all_left) return;
    Polygon rest;
    for (std::size_t i = 0; i < polygon.size; ++i) {
        const std::size_t next = i + 1 < polygon.size ? i + 1 : 0;
        const Corner& a = polygon.corners[i];
        const Corner& b = polygon.corners[next];
        if (left[i] >= 0) rest.add(a);
        if ((left[i] < 0) != (left[next] < 0)) {
            const btScalar t = left[i] / (left[i] - left[next]);
            rest.add({a.u + t * (b.u - a.u), a.v + t * (b.v - a.v)});
        }
    }
    polygon = rest;
}

Polygon shared_area(Polygon area, const Polygon& outline) {
    for (std::size_t i = 0; i < outline.size && area.size > 0; ++i) {
        cut(area, outline.corners[i], outline.corners[i + 1 < outline.size ? i + 1 : 0]);
    }
    return area;
}

// Radius of a cylinder's flat end: without the rounded edge, as Bullet sees it.
btScalar end_radius(const btCylinderShapeZ& cylinder) {
    return cylinder.getHalfExtentsWithoutMargin().x();
}

// The face of each shape that looks most along `towards`.
Face end_of(const btCylinderShapeZ& cylinder, const btTransform& pose, const btVector3& towards) {
    const btVector3 axis = pose.getBasis().getColumn(2);
    const btVector3 normal = axis.dot(towards) >= 0 ? axis : -axis;
    const btVector3 centre = pose.getOrigin() + cylinder.getHalfExtentsWithMargin().z() * normal;
    return {{centre, normal, pose.getBasis().getColumn(0)}, circle({}, end_radius(cylinder))};
}

Face side_of(const btBoxShape& box, const btTransform& pose, const btVector3& towards) {
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

std::optional<Face> face_of(const btConvexHullShape& hull,
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
    return Face{{pose * (found[0] + hull.getMargin() * normal),
                 pose.getBasis() * normal,
                 pose.getBasis() * edge},
                outline};
}

std::optional<Face> find_face(const btCollisionShape& shape,
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

Face plane_of(const btStaticPlaneShape& plane, const btTransform& pose, const btVector3& near_u) {
    const btVector3 normal = pose.getBasis() * plane.getPlaneNormal();
    return {{pose * (plane.getPlaneConstant() * plane.getPlaneNormal()), normal, near_u}, {}};
}

btVector3 centre_of(const btCollisionShape& shape, const btTransform& pose) {
    btVector3 low;
    btVector3 high;
    shape.getAabb(pose, low, high);
    return (low + high) / 2;
}

// The ends of the area's extents along the diagonals of its axes; how thin the area is.
struct Extremes {
    std::array<Corner, 4> corners;
    btScalar thinnest = BT_LARGE_FLOAT;
};

Extremes extremes_of(const Polygon& area) {
    constexpr std::array<Corner, 4> kDirections{{{1, 1}, {-1, 1}, {1, 0}, {0, 1}}};
    Extremes found;
    for (std::size_t d = 0; d < kDirections.size(); ++d) {
        const auto along = [&](const Corner& c) {
            return kDirections[d].u * c.u + kDirections[d].v * c.v;
        };
        const auto [low, high] =
            std::minmax_element(area.corners.begin(),
                                area.corners.begin() + static_cast<std::ptrdiff_t>(area.size),
                                [&](const auto& a, const auto& b) { return along(a) < along(b); });
        const btScalar length = d < 2 ? SIMDSQRT12 : btScalar(1);
        found.thinnest = std::min(found.thinnest, length * (along(*high) - along(*low)));
        if (d < 2) {
            found.corners[d] = *high;
            found.corners[d + 2] = *low;
        }
    }
    return found;
}

}  // namespace

std::optional<FlatTouch> find_flat_touch(const btCylinderShapeZ& cylinder,
                                         const btTransform& world_from_cylinder,
                                         const btCollisionShape& other,
                                         const btTransform& world_from_other,
                                         btScalar reach_m,
                                         const FlatContactOptions& options) {
    const bool is_plane = other.getShapeType() == STATIC_PLANE_PROXYTYPE;
    const btVector3 axis = world_from_cylinder.getBasis().getColumn(2);
    std::optional<Face> face;
    btVector3 towards = centre_of(other, world_from_other) - world_from_cylinder.getOrigin();
    if (is_plane) {
        face = plane_of(static_cast<const btStaticPlaneShape&>(other),
                        world_from_other,
                        world_from_cylinder.getBasis().getColumn(0));
        towards = -face->frame.normal;
    }
    const Face end = end_of(cylinder, world_from_cylinder, towards);
    if (!is_plane) face = find_face(other, world_from_other, -end.frame.normal, options);
    if (!face) return std::nullopt;
    const PlaneFrame& frame = face->frame;
    const btScalar facing = -frame.normal.dot(end.frame.normal);
    const btScalar tilt = frame.normal.cross(axis).length();
    if (facing <= 0 || tilt > options.max_tilt) return std::nullopt;
    const auto gap_at = [&](const Corner& c) {
        return (frame.at(c) - end.frame.origin).dot(end.frame.normal) / facing;
    };
    Polygon area = circle(frame.flat(end.frame.origin), end_radius(cylinder));
    if (face->outline) area = shared_area(area, *face->outline);
    if (area.size < 3) return std::nullopt;

    Extremes extremes = extremes_of(area);
    const Corner& deepest =
        *std::min_element(area.corners.begin(),
                          area.corners.begin() + static_cast<std::ptrdiff_t>(area.size),
                          [&](const auto& a, const auto& b) { return gap_at(a) < gap_at(b); });
    const btScalar least = gap_at(deepest);
    // where the other lies deeper than it is covered, it was met from the side
    if (least > reach_m || -2 * least > extremes.thinnest) return std::nullopt;
    const auto lowest = std::min_element(
        extremes.corners.begin(), extremes.corners.end(), [&](const auto& a, const auto& b) {
            return gap_at(a) < gap_at(b);
        });
    if (least < gap_at(*lowest) - options.deeper_m) *lowest = deepest;  // it tips about this one
    FlatTouch touch{.normal = frame.normal, .points = {}};
    for (std::size_t i = 0; i < touch.points.size(); ++i)
        touch.points[i] = {frame.at(extremes.corners[i]), gap_at(extremes.corners[i])};
    return touch;
}

}  // namespace atrium::physics
