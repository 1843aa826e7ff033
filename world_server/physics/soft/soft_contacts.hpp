#pragma once

#include "world_server/physics/options/soft_options.hpp"
#include "world_server/physics/rigid/supports.hpp"
#include "world_server/physics/soft/soft_sample.hpp"
#include "world_server/physics/soft/soft_scenery.hpp"

#include <LinearMath/btVector3.h>

#include <cstddef>
#include <cstdint>
#include <vector>

class btRigidBody;
class btSoftBody;

namespace atrium::physics {

class PeopleField;

/// A contact constraint: keeps a point of a soft body in front of a moving plane.
struct SoftContact {
    SoftSample sample;
    btScalar sample_kg = 0;  // of contacts with bodies: effective mass of the sample
    btVector3 normal;        // unit length, towards the soft body
    btVector3 point;         // [m] point of the plane at the end of the tick
    btVector3 velocity;      // [m/s] of the plane when the contact was found
    btScalar depth = 0;      // [m] penetration at the start of the tick
    btScalar friction = 0;
    btRigidBody* body = nullptr;     // dynamic body that receives the reaction, or null
    btRigidBody* sleeper = nullptr;  // sleeping body that carries a calm soft body, or null
    btVector3 arm;                   // from the body's centre of mass to the point
    btScalar body_inverse_mass = 0;  // inverse effective mass of the body along the normal
    // What carries the body holds it against pushes of this contact. It gets them after the tick.
    bool is_carried = false;
    // solver state
    btScalar load = 0;               // [N s] sum of pushes on a carried body
    btScalar shift = 0;              // [m] motion of the plane by impulses of earlier substeps
    btScalar normal_correction = 0;  // [kg m] sum of normal corrections in this substep
    btVector3 friction_correction;   // [kg m] sum of friction corrections in this substep
};

/// Of the contacts of one soft body.
struct SoftContactSetup {
    SoftContactOptions options{};
    btScalar tick_s = 0;
    btScalar thickness_m = 0;  // thickness of the soft body on each side of its nodes
    btScalar friction = 0;     // of the soft body; pairs use the geometric mean
    btScalar person_friction = 0;
};

/// The objects that can touch a soft body in a tick.
struct SoftSurroundings {
    const PeopleField* people = nullptr;  // at the start of the tick
    // at the end of the tick; triangle meshes among them are static
    std::vector<btRigidBody*> bodies;
    Supports supports;  // of the moving ones among them
};

/// Contacts of one soft body with people, rigid bodies and scenery, for one tick. The paths of all
/// samples are tested against the moving surfaces once. The contacts also stop samples that would
/// reach a surface within the tick, before they penetrate.
class SoftContacts {
public:
    /// Detects contacts. `people` (or null) is at the start of the tick, `bodies` are at its end.
    /// Within the tick, a body yields to pushes onto what carries it as little as a fixed one: the
    /// rigid bodies' solver, which knows its floor, acts before and after.
    void find(btSoftBody& soft,
              const SoftSkin& skin,
              const PeopleField* people,
              const std::vector<btRigidBody*>& bodies,
              const Supports& supports,
              const SoftContactSetup& setup);
    /// Call when the soft body was moved at once, as by a reset.
    void forget_places() { scenery_.forget(); }
    // For each equal substep of the tick: begin_substep, solve any number of times, end_substep.
    void begin_substep();
    /// Moves the nodes out of penetrated surfaces. `left_s`: from the end of this substep to the
    /// end of the tick.
    void solve(btSoftBody& soft,
               btScalar substep_s,
               btScalar left_s,
               const SoftContactSetup& setup);
    /// Call when the velocities of the substep are known. Removes the speed that resolving a
    /// penetration has added.
    void end_substep(btSoftBody& soft, btScalar substep_s, const SoftContactSetup& setup);

    /// Calls `take` with each body that receives reactions, once or more often.
    template <class Take>
    void visit_bodies(Take&& take) const {
        for (const SoftContact& contact : contacts_)
            if (contact.body != nullptr) take(*contact.body);
    }
    /// Speed at which the heaviest body that it touches moves away from it [m/s]; 0: none.
    btScalar rebound_mps() const;
    /// Mass of the heaviest body that may rest on the soft body [kg]; 0: none.
    btScalar heaviest_kg() const;
    /// Of a cloth or rope: the mass of a body above it in masses of what it touches, the most of
    /// all bodies; 0: none.
    btScalar heaviest_load() const;
    /// Gives carried bodies the sum of the pushes on them. Call after the last substep.
    void load_carriers();
    /// Wakes the sleeping bodies that it touches. Call after the last substep, if the soft body is
    /// no longer calm.
    void wake_bodies();

    std::size_t num_person_contacts() const { return num_person_contacts_; }

private:
    void find_with(const btSoftBody& soft,
                   btRigidBody& body,
                   const SoftSkin& skin,
                   const Supports& supports,
                   const SoftContactSetup& setup);
    void find_with_scenery(const btSoftBody& soft,
                           const std::vector<btRigidBody*>& bodies,
                           const SoftSkin& skin,
                           const SoftContactSetup& setup);

    std::vector<SoftContact> contacts_;
    std::vector<SampleMotion> ways_;  // one per sample
    SoftScenery scenery_;
    std::size_t num_person_contacts_ = 0;
    bool is_calm_ = false;  // as of `find`
};

}  // namespace atrium::physics
