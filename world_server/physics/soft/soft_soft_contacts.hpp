#pragma once

#include "world_server/physics/options/soft_options.hpp"
#include "world_server/physics/soft/moving_faces.hpp"
#include "world_server/physics/soft/soft_object.hpp"
#include "world_server/physics/soft/soft_sample.hpp"

#include <LinearMath/btVector3.h>

#include <cstddef>
#include <span>
#include <vector>

class btSoftBody;

namespace atrium::physics {

/// Surface of a soft body for contacts with other soft bodies. The body's bounds must cover its
/// path through the coming tick.
struct SoftSurface {
    btSoftBody* body = nullptr;
    const SoftTopology* topology = nullptr;
    std::span<const SoftSample> samples;  // points tested against the faces of others
    std::span<const btVector3> outward;   // volumes only, per node: see SoftVolume::outward
    btScalar depth_m = 0;                 // volumes only: depth that another object may reach
    btScalar thickness_m = 0;             // on each side of its nodes
    btScalar friction = 0;
};

/// Contacts between soft bodies, for one tick. Points of one body are tested against faces of the
/// other along their paths, once. Both bodies move. Ropes have no faces: two ropes pass through
/// each other. Self-contacts are not detected.
class SoftSoftContacts {
public:
    explicit SoftSoftContacts(const SoftContactOptions& options) : options_(options) {}

    /// Detects contacts. The order of `surfaces` must be the same in every tick. The data they
    /// point to must exist until the end of the tick.
    void find(std::span<const SoftSurface> surfaces, btScalar tick_s);
    // For each equal substep of the tick: begin_substep, solve any number of times, end_substep.
    void begin_substep();
    /// `left_s`: from the end of this substep to the end of the tick.
    void solve(btScalar left_s);
    /// Call when the velocities of the substep are known. Removes the speed that resolving a
    /// penetration has added.
    void end_substep();

    std::size_t num_contacts() const { return contacts_.size(); }

private:
    struct Contact {
        btSoftBody* body[2]{};  // body of the sample, body of the face
        SoftSample place[2];
        btVector3 normal;      // unit length, towards the first body
        btScalar gap_m = 0;    // required distance along the normal
        btScalar depth_m = 0;  // missing part of gap_m at the start of the tick
        btScalar friction = 0;
        btScalar inverse_mass[2]{};  // inverse effective masses
        // solver state
        btScalar normal_correction = 0;  // [kg m] sum of normal corrections in this substep
        btVector3 friction_correction;   // [kg m] sum of friction corrections in this substep
    };

    void find_with(const SoftSurface& sampled, const SoftSurface& faced, btScalar tick_s);

    SoftContactOptions options_;
    std::vector<Contact> contacts_;
    FaceIndex faces_;  // scratch
    btScalar tick_s_ = 0;
};

}  // namespace atrium::physics
