#include "world_server/physics/soft/moving_faces.hpp"

#include <cmath>

namespace atrium::physics {
namespace {

void include(const btVector3& p, Box& box) {
    box.low.setMin(p);
    box.high.setMax(p);
}

// Barycentric weights of the nearest point on a triangle (Ericson, "Real-Time Collision Detection",
// 2005, section 5.1.5).
btVector3 nearest_on(const btVector3 (&corners)[3], const btVector3& point) {
    const btVector3 ab = corners[1] - corners[0], ac = corners[2] - corners[0];
    const btVector3 ap = point - corners[0];
    const btScalar d1 = ab.dot(ap), d2 = ac.dot(ap);
    if (d1 <= 0 && d2 <= 0) return btVector3(1, 0, 0);
    const btVector3 bp = point - corners[1];
    const btScalar d3 = ab.dot(bp), d4 = ac.dot(bp);
    if (d3 >= 0 && d4 <= d3) return btVector3(0, 1, 0);
    const btScalar vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) {
        const btScalar b = d1 / (d1 - d3);
        return btVector3(1 - b, b, 0);
    }
    const btVector3 cp = point - corners[2];
    const btScalar d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d6 >= 0 && d5 <= d6) return btVector3(0, 0, 1);
    const btScalar vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) {
        const btScalar c = d2 / (d2 - d6);
        return btVector3(1 - c, 0, c);
    }
    const btScalar va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 >= d3 && d5 >= d6) {
        const btScalar c = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return btVector3(0, 1 - c, c);
    }
    return btVector3(va, vb, vc) / (va + vb + vc);
}

// Empty if the face is degenerate.
std::optional<btVector3> normal_of(const MovingFace& face) {
    const btVector3 normal =
        (face.corners[1] - face.corners[0]).cross(face.corners[2] - face.corners[0]);
    const btScalar length = normal.length();
    if (!(length > btScalar(1e-9))) return std::nullopt;  // [m^2]
    return normal / length;
}

// Sets the weights of the nearest point of the face. Returns the distance from it, along the face.
btScalar beside(const btVector3& at, const MovingFace& face, FaceContact& contact) {
    const btVector3 weights = nearest_on(face.corners, at);
    btVector3 off = at;
    for (int i = 0; i < 3; ++i) {
        contact.weights[i] = weights[i];
        off -= face.corners[i] * weights[i];
    }
    off -= contact.normal * contact.normal.dot(off);
    return off.length();
}

}  // namespace

std::optional<FaceContact> find_contact(const SampleMotion& place,
                                        const MovingFace& face,
                                        const btVector3* outward,
                                        const ContactLimits& limits) {
    FaceContact contact;
    btVector3& normal = contact.normal;
    const auto facing_out = normal_of(face);
    if (!facing_out) return std::nullopt;
    normal = *facing_out;
    btScalar& distance = contact.distance;
    distance = normal.dot(place.position - face.corners[0]);
    const btScalar facing = outward != nullptr ? -normal.dot(*outward) : 0;
    if (!face.is_skin && (outward != nullptr ? facing < 0 : distance < 0)) {
        normal = -normal;
        distance = -distance;
    }
    // a contact needs opposed normals: skin on skin, or skin on cloth
    if (outward != nullptr &&
        (face.is_skin ? facing < -limits.from_inside : std::abs(facing) < limits.from_inside))
        return std::nullopt;
    if (distance < -limits.depth_m) return std::nullopt;

    const btVector3 way = (place.velocity - face.velocity) * limits.tick_s;
    const btScalar closing = std::max(btScalar(0), -normal.dot(way));
    if (distance - closing > limits.gap_m + limits.margin_m) return std::nullopt;
    const btScalar until = distance - limits.gap_m;
    const btScalar share = until > 0 && closing > 0 ? std::min(btScalar(1), until / closing) : 0;
    const btVector3 at = place.position + way * share;
    const btScalar off = beside(at, face, contact);
    if (off > limits.gap_m) return std::nullopt;
    contact.way = way.length() * share + std::abs(distance - closing * share) + off;
    return contact;
}

std::optional<FaceContact> find_crossing(const btVector3& from,
                                         const btVector3& to,
                                         const MovingFace& face,
                                         btScalar beside_m) {
    const auto normal = normal_of(face);
    if (!normal) return std::nullopt;
    FaceContact contact;
    const btScalar from_m = normal->dot(from - face.corners[0]);
    const btScalar to_m = normal->dot(to - face.corners[0]);
    if ((from_m > 0) == (to_m > 0)) return std::nullopt;
    contact.normal = from_m > 0 ? *normal : -*normal;
    contact.distance = -std::abs(to_m);
    const btScalar share = from_m / (from_m - to_m);
    const btVector3 way = (to - from) * share;
    if (beside(from + way, face, contact) > beside_m) return std::nullopt;
    contact.way = way.length();
    return contact;
}

Box swept_bounds(const SampleMotion& place, const btVector3* outward, const ContactLimits& limits) {
    Box box{place.position, place.position};
    include(place.position + place.velocity * limits.tick_s, box);
    if (outward != nullptr) include(place.position - *outward * limits.depth_m, box);
    return box;
}

Box swept_bounds(const MovingFace& face, const ContactLimits& limits) {
    Box box{face.corners[0], face.corners[0]};
    btVector3 behind(0, 0, 0);
    if (face.is_skin) {
        behind = (face.corners[1] - face.corners[0]).cross(face.corners[2] - face.corners[0]);
        const btScalar length = behind.length();
        behind *= length > 0 ? -limits.depth_m / length : btScalar(0);
    }
    const btVector3 way = face.velocity * limits.tick_s;
    for (const btVector3& corner : face.corners) {
        include(corner, box);
        include(corner + way, box);
        include(corner + behind, box);
    }
    const btScalar reach = limits.gap_m + limits.margin_m;
    box.low -= btVector3(reach, reach, reach);
    box.high += btVector3(reach, reach, reach);
    return box;
}

void FaceIndex::sort() {
    if (entries_.empty()) return;
    Box all = entries_[0].box;
    btVector3 longest(0, 0, 0);
    for (const Entry& e : entries_) {
        include(e.box.low, all);
        include(e.box.high, all);
        longest.setMax(e.box.high - e.box.low);
    }
    axis_ = (all.high - all.low).maxAxis();
    longest_ = longest[axis_];
    std::stable_sort(entries_.begin(), entries_.end(), [&](const Entry& a, const Entry& b) {
        return a.box.low[axis_] < b.box.low[axis_];
    });
}

}  // namespace atrium::physics
