#pragma once

#include "world_server/physics/moving_faces.hpp"
#include "world_server/physics/soft_sample.hpp"

#include <LinearMath/btVector3.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

class btRigidBody;
class btSoftBody;

namespace atrium::physics {

class PeopleField;

/// A place on a soft body with the plane that it must stay in front of, which moves.
struct SoftContact {
    SoftSample sample;
    btVector3 normal;    // unit length, towards the soft body
    btVector3 point;     // [m] of the plane, at the end of the tick
    btVector3 velocity;  // [m/s] of the plane, when the contact was found
    btScalar depth = 0;  // [m] inside by this at the beginning of the tick
    btScalar friction = 0;
    btRigidBody* body = nullptr;  // that moves and feels it, or null
    btVector3 arm;                // from the body's centre of mass to the point
    btScalar body_share = 0;      // inverse of the body's mass as felt along the normal
    // while it is solved
    btScalar shift = 0;    // [m] how far the impulses of the parts before have moved the plane
    btScalar pressed = 0;  // [kg m] sum of the corrections along the normal in this part
    btVector3 held;        // [kg m] the same of friction
};

struct SoftContactOptions {
    btScalar tick_s = 0;
    btScalar thickness_m = 0;  // that the soft body has on either side of its nodes
    btScalar friction = 0;     // of the soft body; that of a pair is the geometric mean
    btScalar person_friction = 0;
    btScalar margin_m = btScalar(0.004);    // surfaces nearer than this are kept in view
    btScalar recovery_mps = btScalar(0.6);  // at which what is inside comes out
};

/// Where a soft body touches what is around it.
struct SoftSkin {
    std::span<const SoftSample> samples{};
    /// Of a volume, per node, unit length: where it faces by the shape at rest; else empty. A
    /// surface that faces the same way has come up inside the volume, and the skin must not hook on
    /// to it.
    std::span<const btVector3> outward{};
    btScalar depth_m = 0;  // of a volume: how deep a face of scenery may get into it
    std::span<const std::uint8_t> loose{};  // per node; not 0: stretched so far that people cannot
                                            // hold it any more
};

/// What may touch a soft body in a tick.
struct SoftSurroundings {
    const PeopleField* people = nullptr;  // at the beginning of the tick
    std::vector<btRigidBody*> bodies;     // at the end of the tick; meshes among them never move
};

/// The contacts of one soft body for one tick. Samples on their way are tested against the moving
/// surfaces once, and what is found are planes that also hold back what would get there within the
/// tick; so nothing has to be inside before it is stopped.
class SoftContacts {
public:
    /// `people`, or null, is as at the beginning of the tick, `bodies` as at its end.
    void find(btSoftBody& soft,
              const SoftSkin& skin,
              const PeopleField* people,
              const std::vector<btRigidBody*>& bodies,
              const SoftContactOptions& options);
    // The tick goes by in equal parts, each of these: begin, solve as often as wanted, end.
    void begin_part();
    /// Moves the nodes out of what they are in. `left_s`: from the end of this part to the end of
    /// the tick.
    void solve(btSoftBody& soft,
               btScalar part_s,
               btScalar left_s,
               const SoftContactOptions& options);
    /// When the part's velocities are known: takes away the speed of coming out of something.
    void end_part(btSoftBody& soft, btScalar part_s, const SoftContactOptions& options);

    std::size_t num_person_contacts() const { return num_person_contacts_; }

private:
    void find_with(const btSoftBody& soft,
                   btRigidBody& body,
                   const SoftSkin& skin,
                   const SoftContactOptions& options);
    void find_with_mesh(const btSoftBody& soft,
                        const btRigidBody& body,
                        const SoftSkin& skin,
                        const SoftContactOptions& options);

    std::vector<SoftContact> contacts_;
    std::vector<SampleMotion> ways_;  // of the samples
    FaceIndex faces_;                 // scratch
    std::size_t num_person_contacts_ = 0;
};

}  // namespace atrium::physics
