#pragma once

#include "world_server/physics/rigid/mesh_touches.hpp"

#include <vector>

namespace atrium::physics {

/// Chooses the triangles of a mesh that a ball touches.
class BallTriangles {
public:
    explicit BallTriangles(const FlatContactOptions& options) : options_(options) {}

    /// Removes the triangles that the ball cannot touch within `reach_m`. A ball that lies on a
    /// face does not touch the edges in the plane of this face: they would stop it or make it jump.
    /// `centre` is in the mesh's frame.
    void leave_touched(std::vector<MeshTriangle>& triangles,
                       const btVector3& centre,
                       btScalar radius_m,
                       btScalar reach_m);

private:
    struct Nearest {
        btVector3 point{0, 0, 0};
        btVector3 normal{0, 0, 0};  // of the triangle
        bool is_inside = false;     // not on an edge
    };
    Nearest nearest_on(const MeshTriangle& triangle, const btVector3& p) const;

    const FlatContactOptions& options_;
    std::vector<Nearest> places_;  // one per triangle; scratch
};

}  // namespace atrium::physics
