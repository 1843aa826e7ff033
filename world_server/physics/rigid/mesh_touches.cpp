#include "world_server/physics/rigid/mesh_touches.hpp"

#include <cmath>

namespace atrium::physics {

void MeshTouches::begin(const btConvexShape& shape,
                        const btTransform& mesh_from_shape,
                        btScalar reach_m) {
    shape_ = &shape;
    mesh_from_shape_ = mesh_from_shape;
    reach_m_ = reach_m;
    faces_.clear();
    flat_.clear();
    others_.clear();
    touches_.clear();
    last_direction_.setZero();
}

void MeshTouches::add(const MeshTriangle& triangle) {
    const auto& [a, b, c] = triangle.corners;
    Side side{(b - a).cross(c - a), a};
    const btScalar twice_area = side.normal.length();
    if (twice_area < options_.min_triangle_m2) {
        others_.push_back(triangle);
        return;
    }
    side.normal /= twice_area;
    const bool is_turned = side.normal.dot(mesh_from_shape_.getOrigin() - a) < 0;
    if (is_turned) side.normal = -side.normal;
    const btVector3 lowest = mesh_from_shape_ * shape_->localGetSupportingVertex(
                                                    -side.normal * mesh_from_shape_.getBasis());
    if (side.normal.dot(lowest - a) > reach_m_) return;
    Face* face = face_at(side);
    if (face == nullptr) {
        others_.push_back(triangle);
        return;
    }
    flat_.push_back({triangle, static_cast<std::size_t>(face - faces_.data())});
    const PlaneFrame& frame = face->area.face();
    Polygon outline;
    outline.add(frame.flat(a));
    outline.add(frame.flat(is_turned ? c : b));
    outline.add(frame.flat(is_turned ? b : c));
    Polygon foot;
    for (std::size_t i = 0; i < face->foot.outline->size; ++i)
        foot.add(frame.flat(face->foot.frame.at(face->foot.outline->corners[i])));
    face->area.add(shared_area(foot, outline));
}

// The face that the plane belongs to; a new one if it is none of those known.
MeshTouches::Face* MeshTouches::face_at(const Side& side) {
    for (Face& face : faces_) {
        const PlaneFrame& frame = face.area.face();
        if (frame.normal.dot(side.normal) < 1 - options_.same_plane_turn) continue;
        const btScalar off = side.normal.dot(face.foot.frame.origin - side.origin) -
                             frame.normal.dot(face.foot.frame.origin - frame.origin);
        if (std::abs(off) <= options_.same_plane_m) return &face;
    }
    if (faces_.size() == kMaxFaces) return nullptr;
    const std::optional<FlatFace>& foot = foot_towards(-side.normal);
    if (!foot || !foot->outline) return nullptr;
    const FlatFace plane{{side.origin, side.normal, foot->frame.u}, {}};
    if (!lies_flat(plane, *foot, options_)) return nullptr;
    faces_.push_back({FlatArea(plane.frame, foot->frame), *foot});
    return &faces_.back();
}

const std::optional<FlatFace>& MeshTouches::foot_towards(const btVector3& direction) {
    if ((direction - last_direction_).length2() > 0) {
        last_foot_ = find_face(*shape_, mesh_from_shape_, direction, options_);
        last_direction_ = direction;
    }
    return last_foot_;
}

void MeshTouches::finish() {
    for (std::size_t i = 0; i < faces_.size(); ++i) {
        const FlatArea& area = faces_[i].area;
        if (const auto touch = area.touch(reach_m_, options_.min_width_m, options_)) {
            touches_.push_back(*touch);
            continue;
        }
        if (!area.is_empty() && area.least_gap() > reach_m_) continue;
        for (const FlatTriangle& flat : flat_)
            if (flat.face == i) others_.push_back(flat.triangle);
    }
}

}  // namespace atrium::physics
