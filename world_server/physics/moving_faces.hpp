#pragma once

#include "world_server/physics/soft_sample.hpp"

#include <LinearMath/btAabbUtil2.h>
#include <LinearMath/btVector3.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace atrium::physics {

/// A triangle in the world that moves straight on for a tick.
struct MovingFace {
    btVector3 corners[3];  // [m] at the beginning of the tick; counter-clockwise from outside
    btVector3 velocity;    // [m/s] of its middle
    std::uint32_t nodes[3]{0, 0, 0};  // of the soft body that it is of; unused of others
    bool is_skin = false;             // of a volume, which is behind it; else it has two sides
};

/// Where a place meets a face in a tick.
struct FaceMeeting {
    btVector3 normal;       // unit length, of the face, to the side where the place belongs
    btScalar distance = 0;  // [m] of the place along it when the tick began; < 0: behind the face
    btScalar weights[3];    // of the corners, where it meets the face; add up to 1
    btScalar way = 0;       // [m] until then and there: the least is the one that matters
};

struct MeetingLimits {
    btScalar tick_s = 0;
    btScalar gap_m = 0;     // nearer than this is in touch
    btScalar margin_m = 0;  // nearer than that and this is worth knowing of
    btScalar depth_m = 0;   // behind a face by more than this is beyond it, or on another's side
};

/// Whether a place comes to a face in the coming tick, or is behind it. `outward`, or null: unit
/// length, where the skin of a volume faces at that place; it tells on which side of a face of two
/// sides the place belongs, however deep the two are in each other. Without it that is the side
/// where it is.
std::optional<FaceMeeting> meet(const SampleMotion& place,
                                const MovingFace& face,
                                const btVector3* outward,
                                const MeetingLimits& limits);

struct Box {
    btVector3 low, high;  // [m]
};

inline bool touch(const Box& a, const Box& b) {
    return TestAabbAgainstAabb2(a.low, a.high, b.low, b.high);
}

/// Where a place may meet faces: its way through a tick and, of a volume, what is behind its skin.
Box box_of_way(const SampleMotion& place, const btVector3* outward, const MeetingLimits& limits);
/// Where a face may be met.
Box box_of_way(const MovingFace& face, const MeetingLimits& limits);

/// Faces by where they are in a tick. Deterministic; its memory is used again.
class FaceIndex {
public:
    void clear() { entries_.clear(); }
    void add(const MovingFace& face, const MeetingLimits& limits) {
        entries_.push_back({box_of_way(face, limits), face});
    }
    /// After the last `add`.
    void sort();
    bool empty() const { return entries_.empty(); }

    /// Calls `visit(face)` for all faces whose box touches this one.
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

    std::vector<Entry> entries_;  // rising by their low end along axis_
    int axis_ = 0;                // along which they reach furthest
    btScalar longest_ = 0;        // box, along it
};

}  // namespace atrium::physics
