#pragma once

#include "world_server/physics/options/rigid_options.hpp"

#include <btBulletDynamicsCommon.h>

#include <array>

namespace atrium::physics {

/// Finds all contact points at once where cylinders, boxes and hulls lie flat on a triangle mesh.
/// Bullet finds one point per tick and triangle, and keeps four of them for the whole mesh; slim
/// things tip over before these surround their foot. Here each plane has four points of its own.
/// A ball on a face does not touch the edges in its plane. All other contacts with the mesh are
/// left to Bullet.
class MeshContacts {
public:
    MeshContacts(btCollisionDispatcher& dispatcher, const FlatContactOptions& options);
    MeshContacts(const MeshContacts&) = delete;
    MeshContacts& operator=(const MeshContacts&) = delete;

private:
    struct Maker : btCollisionAlgorithmCreateFunc {
        Maker(const FlatContactOptions& flat_options, bool is_mesh_first);
        btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                       const btCollisionObjectWrapper* a,
                                                       const btCollisionObjectWrapper* b) override;
        const FlatContactOptions& options;
        bool mesh_first;
    };

    FlatContactOptions options_;
    std::array<Maker, 2> makers_;
};

}  // namespace atrium::physics
