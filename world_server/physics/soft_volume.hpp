#pragma once

#include "world_server/physics/soft_object.hpp"

#include <LinearMath/btVector3.h>

#include <vector>

class btSoftBody;

namespace atrium::physics {

/// What makes a closed surface of nodes a body: it is drawn back to its shape at rest, its volume
/// is kept, and what moves otherwise than the whole is slowed.
class SoftVolume {
public:
    /// Of `body` as it is at rest, with its bounds found; both must outlive this. `match_share`: of
    /// the way to where the shape at rest would have it, what a node goes in a part of a tick.
    SoftVolume(btSoftBody& body, const SoftTopology& topology, btScalar match_share);

    /// Finds how the body is turned.
    void begin_tick();
    // in each part of a tick
    void match_shape();
    void keep_volume();
    /// Of the velocities at the end of a tick; fall and spin stay.
    void damp_inside(btScalar seconds);

    /// Per node, unit length: the direction in which it faces by the shape at rest, turned as the
    /// body was when the tick began.
    const std::vector<btVector3>& outward() const { return outward_; }
    btScalar inner_radius_m() const { return inner_radius_; }  // half of the smallest extent

private:
    btScalar find_gradients();

    btSoftBody& body_;
    const SoftTopology& topology_;
    btScalar match_share_;
    std::vector<btVector3> gradients_;     // per node, of the volume
    std::vector<btVector3> rest_outward_;  // per node, unit length, of the shape at rest
    std::vector<btVector3> outward_;
    btScalar rest_volume_ = 0;
    btScalar inner_radius_ = 1;
};

}  // namespace atrium::physics
