#pragma once

#include "world_server/physics/soft_object.hpp"

#include <LinearMath/btVector3.h>

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

class btRigidBody;
class btSoftBody;

namespace atrium::physics {

/// The rigid bodies that soft things hold on to. When these are solved, the bodies have already
/// gone their way through the tick: what they gain is to move them all the same, or else they would
/// lag behind what holds them by a tick and swing themselves up.
class TiedBodies {
public:
    // The tick goes by in parts: begin, add each once or more, end each part, end.
    void begin_tick() { bodies_.clear(); }
    void add(btRigidBody& body);
    void end_part(btScalar part_s);
    void end_tick();

private:
    struct Body {
        btRigidBody* body = nullptr;
        btVector3 velocity, spin;  // when the tick began
        btVector3 moved, turned;   // [m, rad] by what it has gained since
    };
    std::vector<Body> bodies_;
};

/// The nodes of one soft body that hold on to rigid bodies: what pulls at one pulls at the other.
class SoftTies {
public:
    /// Where the node and the body are now; they keep that place to each other. Both outlive this,
    /// or the body until `untie`.
    void tie(const btSoftBody& soft, std::uint32_t node, btRigidBody& body);
    /// The body is about to go.
    void untie(const btRigidBody& body);
    /// Whether any node does so.
    bool hold(const btRigidBody& body) const;

    // The tick goes by in equal parts, each of these: solve as often as wanted, end.
    void begin_tick(TiedBodies& bodies);
    /// `left_s`: from the end of this part to the end of the tick.
    void solve(btSoftBody& soft, btScalar part_s, btScalar left_s);
    void end_part(btScalar part_s);
    /// In the end: what hangs on nodes that are marked, one mark per node, has become no faster in
    /// this tick than that, unless it was.
    void limit(std::span<const std::uint8_t> marks, btScalar most_mps);

private:
    struct Tie {
        std::uint32_t node = 0;
        btRigidBody* body = nullptr;
        btVector3 place;     // in the body's frame
        btVector3 velocity;  // of that place when the tick began
        btVector3 shift;     // [m] by what it has gained since
    };
    std::vector<Tie> ties_;
};

}  // namespace atrium::physics
