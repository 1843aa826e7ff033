#pragma once

#include "world_server/physics/soft/soft_sample.hpp"

#include <LinearMath/btAabbUtil2.h>
#include <LinearMath/btVector3.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace atrium::physics {

/// A triangle in the world that moves in a straight line during a tick.
struct MovingFace {
    btVector3 corners[3];  // [m] at the start of the tick; counter-clockwise from outside
    btVector3 velocity;    // [m/s] of the centroid
    // node indices if the face belongs to a soft body; otherwise unused
    std::uint32_t nodes[3]{0, 0, 0};
    btScalar friction = 0;  // of scenery; unused for soft bodies
    bool is_skin = false;   // true: boundary of a volume behind it; false: two-sided
};

/// Contact of a point and a face within a tick.
struct FaceContact {
    btVector3 normal;  // unit length, of the face, on the point's side
    // [m] of the point along the normal at the start of the tick; < 0: behind the face
    btScalar distance = 0;
    btScalar weights[3];  // barycentric weights of the contact point; add up to 1
    btScalar way = 0;     // [m] path length to the contact; the smallest matters
};

struct ContactLimits {
    btScalar tick_s = 0;
    btScalar gap_m = 0;        // a smaller distance is a contact
    btScalar margin_m = 0;     // added to gap_m: contacts up to here are reported
    btScalar depth_m = 0;      // a point further behind a face is not in contact with it
    btScalar from_inside = 0;  // cosine; see SoftContactOptions
};

/// Tests whether a point reaches a face in the coming tick or is behind it. Empty if not.
///
/// `outward` is null or the unit outward normal of the volume at the point. It decides on which
/// side of a two-sided face the point belongs, at any depth. If it is null, the point belongs to
/// the side where it is.
std::optional<FaceContact> find_contact(const SampleMotion& place,
                                        const MovingFace& face,
                                        const btVector3* outward,
                                        const ContactLimits& limits);

/// Tests whether the straight line from `from` to `to` passes through a face, or beside it by at
/// most `beside_m`. The normal of the contact points to the side of `from`, its distance is that of
/// `to`, and its way is the length of the line up to the face. Empty if not.
std::optional<FaceContact> find_crossing(const btVector3& from,
                                         const btVector3& to,
                                         const MovingFace& face,
                                         btScalar beside_m);

struct Box {
    btVector3 low, high;  // [m]
};

inline bool touch(const Box& a, const Box& b) {
    return TestAabbAgainstAabb2(a.low, a.high, b.low, b.high);
}

/// Bounds of the contacts of a point: its path through a tick and, for a volume, the depth behind
/// its boundary.
Box swept_bounds(const SampleMotion& place, const btVector3* outward, const ContactLimits& limits);
/// Bounds of the contacts of a face.
Box swept_bounds(const MovingFace& face, const ContactLimits& limits);

/// Sorted index of faces by their bounds in a tick (sweep and prune along one axis). Deterministic.
/// Reuses its memory.
class FaceIndex {
public:
    void clear() { entries_.clear(); }
    void add(const MovingFace& face, const ContactLimits& limits) {
        entries_.push_back({swept_bounds(face, limits), face});
    }
    /// Call after the last `add`.
    void sort();
    bool empty() const { return entries_.empty(); }

    /// Calls `visit(face)` for each face whose box touches `box`.
    template <typename Visit>
    void visit_box(const Box& box, const Visit& visit) const {
        const auto begin =
            std::lower_bound(entries_.begin(),
                             entries_.end(),
                             box.low[axis_] - longest_,
                             [&](const Entry& e, btScalar at) { return e.box.low[axis_] < at; });
        for (auto e = begin; e != entries_.end() && e->box.low[axis_] <= box.high[axis_]; ++e) {
            if (touch(e->box, box)) visit(e->face);
        }
    }

private:
    struct Entry {
        Box box;
        MovingFace face;
    };

    std::vector<Entry> entries_;  // ascending by their lower end along axis_
    int axis_ = 0;                // the axis with the largest total extent
    btScalar longest_ = 0;        // longest box along axis_
};

}  // namespace atrium::physics
