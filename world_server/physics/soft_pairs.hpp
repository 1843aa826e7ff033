#pragma once

#include "world_server/physics/moving_faces.hpp"
#include "world_server/physics/soft_object.hpp"
#include "world_server/physics/soft_sample.hpp"

#include <LinearMath/btVector3.h>

#include <cstddef>
#include <span>
#include <vector>

class btSoftBody;

namespace atrium::physics {

/// What others touch of a soft body. Its bounds are those of its way through the coming tick.
struct SoftSurface {
    btSoftBody* body = nullptr;
    const SoftTopology* topology = nullptr;
    std::span<const SoftSample> samples;  // that are tested against others' faces
    std::span<const btVector3> outward;   // of a volume, per node: see SoftVolume; else empty
    btScalar depth_m = 0;                 // of a volume: how deep a thing may get into it
    btScalar thickness_m = 0;             // on either side of its nodes
    btScalar friction = 0;
};

/// The contacts of soft bodies with each other for one tick: places of the one with faces of the
/// other, found once on their way. Both sides move. A rope has no faces, so two ropes pass through
/// each other, and a thing does through itself.
class SoftPairs {
public:
    /// `surfaces`: in an order that is the same each time; what they point to stays until the tick
    /// is over.
    void find(std::span<const SoftSurface> surfaces, btScalar tick_s);
    // The tick goes by in equal parts, each of these: begin, solve as often as wanted, end.
    void begin_part();
    /// `left_s`: from the end of this part to the end of the tick.
    void solve(btScalar left_s);
    /// When the part's velocities are known: takes away the speed of coming out of something.
    void end_part();

    std::size_t num_contacts() const { return contacts_.size(); }

private:
    struct Contact {
        btSoftBody* body[2]{};  // the one whose sample it is, and the one with the face
        SoftSample place[2];
        btVector3 normal;      // unit length, towards the first
        btScalar gap_m = 0;    // that they keep along it
        btScalar depth_m = 0;  // what of it is missing at the beginning of the tick
        btScalar friction = 0;
        btScalar share[2]{};  // inverse masses as felt at the places
        // while it is solved
        btScalar pressed = 0;  // [kg m] sum of the corrections along the normal in this part
        btVector3 held;        // [kg m] the same of friction
    };

    void find_with(const SoftSurface& sampled, const SoftSurface& faced, btScalar tick_s);

    std::vector<Contact> contacts_;
    FaceIndex faces_;  // scratch
    btScalar tick_s_ = 0;
};

}  // namespace atrium::physics
