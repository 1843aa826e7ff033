#pragma once

#include "world_server/physics/options/soft_options.hpp"

#include <LinearMath/btVector3.h>

#include <vector>

class btSoftBody;

namespace atrium::physics {

class PeopleField;

/// Pushes a soft volume as a whole when a person's surface is near its centre or around it. The few
/// nodes in contact could not do this.
class SoftDepenetration {
public:
    /// Finds the pushes of one tick. `inner_radius_m`: half of the volume's smallest extent.
    /// `escape_mps`: speed at which a volume inside a person is moved out. Returns false while it
    /// is moved out; then the volume must have no contacts with people.
    bool find(const btSoftBody& soft,
              btScalar inner_radius_m,
              btScalar escape_mps,
              const SoftDepenetrationOptions& options,
              const PeopleField& people);
    void clear() { pushes_.clear(); }
    /// Raises the velocity of every free node to at least the speeds found.
    void apply(btSoftBody& soft) const;

private:
    struct Push {
        btVector3 out;       // unit length
        btScalar speed = 0;  // [m/s] along it
    };
    std::vector<Push> pushes_;
};

}  // namespace atrium::physics
