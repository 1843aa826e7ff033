#pragma once

#include "core/geometry/aabb.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <cstddef>
#include <memory>
#include <vector>

class btDynamicsWorld;
class btRigidBody;

namespace atrium::physics {

inline constexpr std::size_t kMaxStillTriangles = 100'000;

/// What never moves and is no object: solid scenery.
struct StillMesh {
    geometry::TriangleMesh mesh;  // in the world [m]; any triangles, solid from both sides
    double friction = 0.6;
    double restitution = 0.2;
};

/// Of a world: meshes and the walls of its bounds.
class Surroundings {
public:
    /// `world` outlives this. All is of collision group `group` and collides with the groups of
    /// `mask`.
    Surroundings(btDynamicsWorld& world, int group, int mask);
    ~Surroundings();
    Surroundings(const Surroundings&) = delete;
    Surroundings& operator=(const Surroundings&) = delete;

    /// False, and nothing added, where it has no triangles or more than kMaxStillTriangles, or
    /// where a vertex is not a finite number.
    bool add(const StillMesh& mesh);
    /// Six planes that keep everything inside.
    void add_walls(const geometry::Aabb& box);
    /// All of it, none of which moves.
    const std::vector<btRigidBody*>& bodies() const { return bodies_; }

private:
    struct Piece;
    void place(std::unique_ptr<Piece> piece, double friction, double restitution);
    btDynamicsWorld& world_;
    int group_, mask_;
    std::vector<std::unique_ptr<Piece>> pieces_;
    std::vector<btRigidBody*> bodies_;  // theirs
};

}  // namespace atrium::physics
