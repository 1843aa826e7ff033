#pragma once

#include <LinearMath/btVector3.h>

#include <cstddef>
#include <cstdint>
#include <vector>

class btRigidBody;
class btSoftBody;

namespace atrium::physics {

class PeopleField;

/// A place on a soft body that is tested for contacts: a node, or the middle of a face.
struct SoftSample {
    std::uint32_t nodes[3];
    btScalar weights[3];  // add up to 1
};

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

/// What may touch a soft body in a tick.
struct SoftSurroundings {
    const PeopleField* people = nullptr;  // at the beginning of the tick
    std::vector<btRigidBody*> bodies;     // at the end of the tick
};

/// The contacts of one soft body for one tick. Samples on their way are tested against the moving
/// surfaces once, and what is found are planes that also hold back what would get there within the
/// tick; so nothing has to be inside before it is stopped.
class SoftContacts {
public:
    /// `outward`: of a volume, the direction in which each node faces by the shape at rest; else
    /// empty. A surface that faces the same way has come up inside the volume, and the skin must
    /// not hook on to it. `people`, or null, is as at the beginning of the tick, `bodies` as at its
    /// end. `loose[i]` != 0: node i is stretched so far that people cannot hold it any more.
    void find(btSoftBody& soft,
              const std::vector<SoftSample>& samples,
              const std::vector<std::uint8_t>& loose,
              const std::vector<btVector3>& outward,
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

    struct Moving {
        btVector3 position;  // at the beginning of the tick
        btVector3 velocity;
        btScalar share;  // inverse of the mass
    };

private:
    void find_with(const btSoftBody& soft,
                   btRigidBody& body,
                   const std::vector<SoftSample>& samples,
                   const SoftContactOptions& options);

    std::vector<SoftContact> contacts_;
    std::vector<Moving> ways_;  // of the samples
    std::size_t num_person_contacts_ = 0;
};

}  // namespace atrium::physics
