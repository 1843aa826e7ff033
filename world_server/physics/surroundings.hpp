#pragma once

#include "core/geometry/aabb.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <cstddef>
#include <memory>
#include <vector>

class btDynamicsWorld;
class btRigidBody;

namespace atrium::physics {

inline constexpr std::size_t kMaxStaticTriangles = 100'000;

/// A piece of solid scenery: static, and not an object.
struct StaticMesh {
    geometry::TriangleMesh mesh;  // in the world [m]; any triangles, solid on both sides
    double friction = 0.6;
    double restitution = 0.2;
};

/// Owns the static parts of a world: meshes and the walls of its bounds.
class Surroundings {
public:
    /// `world` must outlive this. All bodies get the collision group `group` and collide with the
    /// groups in `mask`.
    Surroundings(btDynamicsWorld& world, int group, int mask);
    ~Surroundings();
    Surroundings(const Surroundings&) = delete;
    Surroundings& operator=(const Surroundings&) = delete;

    /// Adds a mesh. Returns false and adds nothing if it has no triangles, more than
    /// kMaxStaticTriangles, or a vertex that is not finite.
    bool add(const StaticMesh& mesh);
    /// Adds six planes that keep everything inside `box`.
    void add_walls(const geometry::Aabb& box, double friction, double restitution);
    /// All bodies; all are static.
    const std::vector<btRigidBody*>& bodies() const { return bodies_; }

private:
    struct Piece;
    void place(std::unique_ptr<Piece> piece, double friction, double restitution);
    btDynamicsWorld& world_;
    int group_, mask_;
    std::vector<std::unique_ptr<Piece>> pieces_;
    std::vector<btRigidBody*> bodies_;  // bodies of pieces_
};

}  // namespace atrium::physics
