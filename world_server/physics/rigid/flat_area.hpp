#pragma once

#include "world_server/physics/options/rigid_options.hpp"

#include <btBulletCollisionCommon.h>

#include <array>
#include <cstddef>
#include <optional>

namespace atrium::physics {

/// A place in a plane, along its two axes [m].
struct Corner {
    btScalar u = 0;
    btScalar v = 0;
};

/// A convex polygon in a plane.
struct Polygon {
    static constexpr std::size_t kMaxCorners = 40;
    std::array<Corner, kMaxCorners> corners;
    std::size_t size = 0;

    void add(const Corner& corner) {
        if (size < corners.size()) corners[size++] = corner;
    }
};

/// Axes of a plane; u, v and the normal are right-handed.
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

inline constexpr std::size_t kNumRim = 16;  // corners that stand for a circle

/// Makes a polygon of kNumRim corners; four of them lie at the diagonals of the axes, where the
/// points of contact are sought.
Polygon circle(const Corner& centre, btScalar radius);

/// Returns the part of `area` inside `outline`, whose corners are counter-clockwise.
Polygon shared_area(Polygon area, const Polygon& outline);

struct FlatPoint {
    btVector3 on_face{0, 0, 0};
    btScalar gap = 0;  // from the face to the end; negative inside
};

struct FlatTouch {
    btVector3 normal{0, 0, 0};  // of the face, towards the end
    std::array<FlatPoint, 4> points;
};

/// The area in which a flat end of a body lies on a flat face. It may consist of several polygons.
class FlatArea {
public:
    /// The normals point out of the bodies, so they are nearly opposite.
    FlatArea(const PlaneFrame& face, const PlaneFrame& end);

    /// Adds a polygon in the axes of the face.
    void add(const Polygon& polygon);
    const PlaneFrame& face() const { return face_; }
    bool is_empty() const { return is_empty_; }
    /// Smallest gap of all corners; infinite if the area is empty.
    btScalar least_gap() const { return deepest_.gap; }
    /// Returns four points that span the area. None if it is empty or narrower than `min_width_m`,
    /// if its points are farther than `reach_m` from each other, or if the end is deeper in the
    /// face than the area is wide: then the two met from the side.
    std::optional<FlatTouch> touch(btScalar reach_m,
                                   btScalar min_width_m,
                                   const FlatContactOptions& options) const;

private:
    struct Place {
        Corner corner;
        btScalar gap = BT_LARGE_FLOAT;
    };
    struct Extent {
        btScalar low = BT_LARGE_FLOAT;
        btScalar high = -BT_LARGE_FLOAT;
        Place at_low;
        Place at_high;
    };
    btScalar gap_at(const Corner& c) const;

    PlaneFrame face_;
    PlaneFrame end_;
    btScalar facing_;
    std::array<Extent, 4> extents_;  // along the diagonals of the axes, then along the axes
    Place deepest_;
    bool is_empty_ = true;
};

}  // namespace atrium::physics
