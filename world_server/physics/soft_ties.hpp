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

/// The nodes of one soft body that hold on to rigid bodies: what pulls at one pulls at the other.
class SoftTies {
public:
    /// Where the node and the body are now; they keep that place to each other. Both outlive this,
    /// or the body until `untie`.
    void tie(const btSoftBody& soft, std::uint32_t node, btRigidBody& body);
    /// The body is about to go.
    void untie(const btRigidBody& body);

    // The tick goes by in equal parts, each of these: solve as often as wanted, end.
    void begin_tick();
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
        btVector3 shift;     // [m] that impulses have moved it in this tick
    };
    std::vector<Tie> ties_;
};

}  // namespace atrium::physics
