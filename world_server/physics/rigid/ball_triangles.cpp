#include "world_server/physics/rigid/ball_triangles.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::physics {
namespace {

btVector3 nearest_on_edge(const btVector3& a, const btVector3& b, const btVector3& p) {
    const btVector3 along = b - a;
    const btScalar length2 = along.length2();
    if (length2 <= 0) return a;
    return a + std::clamp((p - a).dot(along) / length2, btScalar(0), btScalar(1)) * along;
}

}  // namespace

BallTriangles::Nearest BallTriangles::nearest_on(const MeshTriangle& triangle,
                                                 const btVector3& p) const {
    const auto& [a, b, c] = triangle.corners;
    Nearest nearest;
    nearest.normal = (b - a).cross(c - a);
    const btScalar twice_area = nearest.normal.length();
    if (twice_area >= options_.min_triangle_m2) {
        nearest.normal /= twice_area;
        const auto is_left = [&](const btVector3& from, const btVector3& to) {
            return (to - from).cross(p - from).dot(nearest.normal) >= 0;
        };
        nearest.is_inside = is_left(a, b) && is_left(b, c) && is_left(c, a);
        nearest.point = p - nearest.normal * nearest.normal.dot(p - a);
    }
    if (nearest.is_inside) return nearest;
    nearest.point = nearest_on_edge(a, b, p);
    for (const btVector3& other : {nearest_on_edge(b, c, p), nearest_on_edge(c, a, p)})
        if ((other - p).length2() < (nearest.point - p).length2()) nearest.point = other;
    return nearest;
}

void BallTriangles::leave_touched(std::vector<MeshTriangle>& triangles,
                                  const btVector3& centre,
                                  btScalar radius_m,
                                  btScalar reach_m) {
    places_.clear();
    const btScalar farthest = radius_m + reach_m;
    std::erase_if(triangles, [&](const MeshTriangle& triangle) {
        const Nearest nearest = nearest_on(triangle, centre);
        const bool is_far = (nearest.point - centre).length2() > farthest * farthest;
        if (!is_far) places_.push_back(nearest);
        return is_far;
    });
    std::size_t at = 0;
    std::erase_if(triangles, [&](const MeshTriangle&) {
        const Nearest& place = places_[at++];
        return !place.is_inside &&
               std::any_of(places_.begin(), places_.end(), [&](const auto& face) {
                   return face.is_inside && std::abs(face.normal.dot(place.point - face.point)) <=
                                                options_.same_plane_m;
               });
    });
}

}  // namespace atrium::physics
