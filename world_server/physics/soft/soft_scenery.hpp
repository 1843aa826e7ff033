#pragma once

#include "world_server/physics/soft/moving_faces.hpp"
#include "world_server/physics/soft/soft_sample.hpp"

#include <LinearMath/btVector3.h>

#include <cstddef>
#include <span>
#include <vector>

class btRigidBody;

namespace atrium::physics {

/// A static triangle mesh, whose faces are solid on both sides.
bool is_scenery(const btRigidBody& body);

/// A sample of a soft body in contact with a face of solid scenery.
struct SceneryContact {
    std::size_t sample = 0;  // index
    btVector3 normal;        // unit length, of the face, towards the side where the sample belongs
    btScalar distance = 0;   // [m] of the sample along the normal; < 0: pressed through the face
    btScalar way = 0;        // [m] path length to the contact; the smallest matters
    btScalar friction = 0;   // of the scenery
};

/// Finds the contacts of one soft body with solid scenery.
///
/// Scenery need not be closed, so where a sample is does not tell whether it was pressed through a
/// face. Instead each sample remembers the last place where it was free. The faces between that
/// place and the sample are those that it was pressed through, and it belongs in front of them.
class SoftScenery {
public:
    /// Forgets where the samples were free. Call when the soft body was moved at once.
    void forget() { free_.clear(); }

    /// `ways`: of the skin's samples in the coming tick. `bounds`: of all of them [m]. Of faces in
    /// one direction (`same_normal`: cosine) a sample touches the nearest. In a corner it can touch
    /// faces in three directions. A sample further than `limits.depth_m` from where it was free is
    /// given up: it belongs where it is. The result is valid until the next call.
    std::span<const SceneryContact> find(const SoftSkin& skin,
                                         std::span<const SampleMotion> ways,
                                         std::span<btRigidBody* const> bodies,
                                         const Box& bounds,
                                         const ContactLimits& limits,
                                         btScalar same_normal);

private:
    void remember(const SoftSkin& skin, std::span<const SampleMotion> ways, btScalar lost_m);
    void collect(std::span<btRigidBody* const> bodies, Box bounds, const ContactLimits& limits);
    void find_of(std::size_t sample,
                 const SampleMotion& way,
                 const ContactLimits& limits,
                 btScalar same_normal);
    bool is_free(const btVector3& from, const btVector3& to) const;

    std::vector<btVector3> free_;  // [m] per sample: where it was free
    FaceIndex faces_;
    std::vector<SceneryContact> contacts_;
};

}  // namespace atrium::physics
