#pragma once

#include <LinearMath/btVector3.h>

#include <vector>

class btSoftBody;

namespace atrium::physics {

class PeopleField;

/// How people move a soft volume whose middle they are near or around: as a whole, whatever its few
/// nodes in touch achieve.
class SoftDrives {
public:
    /// For one tick. `inner_radius_m`: half of the volume's smallest extent; `escape_mps`: at which
    /// what is inside a person is led out. False: it is being led out, and must have no contacts
    /// with people.
    bool find(const btSoftBody& soft,
              btScalar inner_radius_m,
              btScalar escape_mps,
              const PeopleField& people);
    void clear() { drives_.clear(); }
    /// Gives every node that moves at least the speeds found.
    void apply(btSoftBody& soft) const;

private:
    struct Drive {
        btVector3 out;       // unit length
        btScalar speed = 0;  // [m/s] along it
    };
    std::vector<Drive> drives_;
};

}  // namespace atrium::physics
