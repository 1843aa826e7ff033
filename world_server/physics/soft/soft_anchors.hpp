#pragma once

#include "world_server/physics/soft/soft_object.hpp"

#include <LinearMath/btVector3.h>

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

class btRigidBody;
class btSoftBody;

namespace atrium::physics {

/// The rigid bodies to which soft bodies are anchored or that they carry.
///
/// The soft solver runs after the rigid bodies have completed their tick. The velocity that they
/// gain from soft bodies must still move them in this tick. Otherwise they would lag behind by one
/// tick and start to oscillate: a box on a sheet would jump about. Bodies that stand on a fixed one
/// are left out: the motion would take no notice of their contacts, and a table would creep.
class AnchoredBodies {
public:
    // Order of calls in a tick: begin_tick; add for each body, once or more; end_substep after each
    // substep; end_tick.
    void begin_tick() { bodies_.clear(); }
    void add(btRigidBody& body);
    void end_substep(btScalar substep_s);
    void end_tick();

private:
    struct Body {
        btRigidBody* body = nullptr;
        btVector3 velocity, spin;  // at the start of the tick
        btVector3 moved, turned;   // [m, rad] motion by the velocity gained since
    };
    std::vector<Body> bodies_;
};

/// Anchors nodes of one soft body to rigid bodies. Forces act on both.
class SoftAnchors {
public:
    /// Anchors a node at its current place in the body's frame. Both must outlive this, or the body
    /// must exist until `detach`.
    void attach(const btSoftBody& soft, std::uint32_t node, btRigidBody& body);
    /// Removes the anchors of a body that is about to be removed.
    void detach(const btRigidBody& body);
    /// True if any node is anchored to `body`.
    bool is_attached_to(const btRigidBody& body) const;

    // For each equal substep of the tick: solve any number of times, then end_substep.
    void begin_tick(AnchoredBodies& bodies);
    /// `left_s`: from the end of this substep to the end of the tick.
    void solve(btSoftBody& soft, btScalar substep_s, btScalar left_s);
    void end_substep(btScalar substep_s);
    /// Call at the end of the tick. Limits the speed of the bodies anchored to marked nodes (one
    /// mark per node) to `most_mps`, or to the speed at the start of the tick if that was higher.
    void limit(std::span<const std::uint8_t> marks, btScalar most_mps);

private:
    struct Anchor {
        std::uint32_t node = 0;
        btRigidBody* body = nullptr;
        btVector3 place;     // in the body's frame
        btVector3 velocity;  // of that place at the start of the tick
        btVector3 shift;     // [m] motion by the velocity gained since
    };
    std::vector<Anchor> anchors_;
};

}  // namespace atrium::physics
