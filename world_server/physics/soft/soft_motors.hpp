#pragma once

#include <LinearMath/btVector3.h>

#include <cstdint>
#include <vector>

class btSoftBody;

namespace atrium::physics {

/// A weighted group of free nodes by which a soft body is held.
struct SoftHandle {
    std::vector<std::uint32_t> nodes;
    std::vector<btScalar> weights;  // add up to 1
    btVector3 offset{0, 0, 0};      // [m] from the weighted mean of the nodes to the held point
};

/// Creates a handle at a point [m, world]: all free nodes within `hand_m` of it, or else the
/// nearest free node. Empty if no node is free.
SoftHandle handle_at(const btSoftBody& soft, const btVector3& point, btScalar hand_m);
/// Returns the held point [m, world].
btVector3 place_of(const btSoftBody& soft, const SoftHandle& handle);

/// Velocity motors: drive each handle of one soft body to a velocity with a bounded force.
class SoftMotors {
public:
    /// Adds a motor for the coming tick. `velocity` [m/s]: target velocity of the held point.
    void add(const SoftHandle& handle, const btVector3& velocity, btScalar max_force_n);
    bool empty() const { return motors_.empty(); }

    // For each equal substep of the tick: begin_substep, then solve any number of times. `done_s`:
    // from the start of the tick to the end of the substep.
    void begin_tick(const btSoftBody& soft);
    void begin_substep();
    void solve(btSoftBody& soft, btScalar substep_s, btScalar done_s);
    /// Call after the last substep. Damps motion relative to the handle: what hangs from it comes
    /// to rest.
    void damp_swing(btSoftBody& soft, btScalar tick_s, btScalar damping_hz) const;
    void end_tick() { motors_.clear(); }

private:
    struct Motor {
        SoftHandle handle;
        btVector3 velocity;
        btScalar max_force_n = 0;
        btVector3 start{0, 0, 0};  // [m] held point at the start of the tick
        btVector3 given{0, 0, 0};  // [kg m] given in this substep
    };
    std::vector<Motor> motors_;
};

}  // namespace atrium::physics
