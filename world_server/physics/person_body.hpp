#pragma once

#include "world_server/physics/person_shape.hpp"

#include <cstddef>
#include <memory>
#include <vector>

class btDiscreteDynamicsWorld;

namespace atrium::physics {

/// Collision groups of the Bullet world, one bit each.
enum CollisionGroup : int { kStillGroup = 1, kObjectGroup = 2, kPersonGroup = 4 };

struct PersonMaterial {
    double friction = 0.0;
    double restitution = 0.0;
};

/// One person's pieces in a Bullet world: kinematic bodies that are reused from mesh to mesh, so
/// that their number stays bounded by the largest shape's.
class PersonBody {
public:
    /// `world` must outlive this.
    PersonBody(btDiscreteDynamicsWorld& world, const PersonMaterial& material);
    ~PersonBody();
    PersonBody(const PersonBody&) = delete;
    PersonBody& operator=(const PersonBody&) = delete;

    /// The pieces' bodies have this PersonBody as their user pointer.
    void set_shape(const PersonShape& shape);
    /// To be called by the pre-tick callback: puts the pieces where they are at the beginning of
    /// the tick, and gives them the velocities that carry them through it. (Bullet overwrites the
    /// velocities of kinematic bodies before each tick, so they must be set here.)
    void begin_tick(double tick_s);

    const SurfaceIndex& surface() const { return *surface_; }
    std::size_t num_pieces() const { return num_used_; }

private:
    struct Piece;
    void place(Piece& piece, double time_to_go_s) const;

    btDiscreteDynamicsWorld& world_;
    PersonMaterial material_;
    std::vector<std::unique_ptr<Piece>> pool_;  // the first num_used_ are in the world
    std::size_t num_used_ = 0;
    std::shared_ptr<const SurfaceIndex> surface_;
    double time_to_go_s_ = 0.0;  // until the pieces are where the mesh was captured
};

}  // namespace atrium::physics
