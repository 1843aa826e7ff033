#pragma once

#include <LinearMath/btVector3.h>

#include <cstdint>
#include <vector>

class btSoftBody;

namespace atrium::physics {

/// A handful of a soft body: nodes that move, and how firmly each is held.
struct SoftHandle {
    std::vector<std::uint32_t> nodes;
    std::vector<btScalar> weights;  // add up to 1
    btVector3 offset{0, 0, 0};      // [m] from the nodes' mean to the point that is held
};

/// What is held of `soft` at a point [m, world]: all that moves within a hand's reach of it, or
/// the nearest node that moves. No nodes: nothing moves.
SoftHandle handle_at(const btSoftBody& soft, const btVector3& point);
/// [m] world.
btVector3 place_of(const btSoftBody& soft, const SoftHandle& handle);

/// How handles of one soft body are pulled in a tick: each to a velocity, with a bounded force.
class SoftPulls {
public:
    /// For the coming tick. `velocity` [m/s] is that which the held point shall have.
    void add(const SoftHandle& handle, const btVector3& velocity, btScalar max_force_n);
    bool empty() const { return pulls_.empty(); }

    // The tick goes by in equal parts, each of these: begin, solve as often as wanted. `done_s`:
    // from the beginning of the tick to the end of the part.
    void begin_tick(const btSoftBody& soft);
    void begin_part();
    void solve(btSoftBody& soft, btScalar part_s, btScalar done_s);
    /// After the last part: slows what swings about the handle, so that what hangs from it comes to
    /// rest.
    void damp_swing(btSoftBody& soft, btScalar tick_s) const;
    void end_tick() { pulls_.clear(); }

private:
    struct Pull {
        SoftHandle handle;
        btVector3 velocity;
        btScalar max_force_n = 0;
        btVector3 start{0, 0, 0};  // [m] where the held point is when the tick begins
        btVector3 given{0, 0, 0};  // [kg m] in this part
    };
    std::vector<Pull> pulls_;
};

}  // namespace atrium::physics
