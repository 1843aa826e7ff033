#pragma once

#include "world_server/physics/options/rigid_options.hpp"

#include <btBulletDynamicsCommon.h>

#include <array>
#include <list>

namespace atrium::physics {

/// Finds all contact points at once where the flat end of a cylinder lies on something flat.
/// Bullet finds one point per tick for curved shapes, often the middle of the end: whatever stands
/// on it tips like a ball on a needle. Every other contact is left to Bullet's own algorithm.
class FlatContacts {
public:
    FlatContacts(btCollisionDispatcher& dispatcher,
                 btCollisionConfiguration& configuration,
                 const FlatContactOptions& options);
    FlatContacts(const FlatContacts&) = delete;
    FlatContacts& operator=(const FlatContacts&) = delete;

private:
    struct Maker : btCollisionAlgorithmCreateFunc {
        Maker(btCollisionAlgorithmCreateFunc& others, const FlatContactOptions& flat_options);
        btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                       const btCollisionObjectWrapper* a,
                                                       const btCollisionObjectWrapper* b) override;
        btCollisionAlgorithmCreateFunc& bullets;
        const FlatContactOptions& options;
    };

    FlatContactOptions options_;
    std::list<Maker> makers_;
};

}  // namespace atrium::physics
