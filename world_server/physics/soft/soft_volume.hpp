#pragma once

#include "world_server/physics/options/soft_options.hpp"
#include "world_server/physics/soft/soft_object.hpp"

#include <LinearMath/btVector3.h>

#include <vector>

class btSoftBody;

namespace atrium::physics {

/// Makes a closed surface of nodes behave like a body: matches its rest shape, preserves its
/// volume, and damps motion relative to the whole.
class SoftVolume {
public:
    /// `body` must be at rest with valid bounds; it and `topology` must outlive this.
    /// `match_share`: share of the way to its place in the rest shape that a node moves in a
    /// substep of SoftOptions::substep_s.
    SoftVolume(btSoftBody& body,
               const SoftTopology& topology,
               btScalar match_share,
               const SoftVolumeOptions& options);

    /// Finds the rotation of the body.
    void begin_tick();
    // in each substep; `part`: of SoftOptions::substep_s
    void match_shape(btScalar part);
    void keep_volume();
    /// Says at which speed [m/s] a body that pressed it moves away. Foam gives back less than it
    /// takes: then its forces are weaker.
    void set_rebound(btScalar mps) {
        share_ = mps > options_.rebound_mps ? options_.rebound_share : btScalar(1);
    }
    /// Damps velocities at the end of a tick. Keeps linear and angular motion of the whole.
    void damp_inside(btScalar seconds);

    /// Per node: outward unit normal of the rest shape, with the body's rotation at the start of
    /// the tick.
    const std::vector<btVector3>& outward() const { return outward_; }
    btScalar inner_radius_m() const { return inner_radius_; }  // half of the smallest extent

private:
    btScalar find_gradients();

    btSoftBody& body_;
    const SoftTopology& topology_;
    btScalar match_share_;
    btScalar share_ = 1;  // of the forces, in this tick
    SoftVolumeOptions options_;
    std::vector<btVector3> gradients_;     // per node: gradient of the volume
    std::vector<btVector3> rest_outward_;  // per node: unit normals of the rest shape
    std::vector<btVector3> outward_;
    btScalar rest_volume_ = 0;
    btScalar inner_radius_ = 1;
};

}  // namespace atrium::physics
