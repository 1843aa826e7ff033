#pragma once

#include "core/base/timestamp.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "world_server/physics/moving_surfel.hpp"
#include "world_server/physics/solid_cells.hpp"
#include "world_server/physics/surface_index.hpp"

#include <Eigen/Core>

#include <memory>
#include <vector>

namespace atrium::physics {

struct PersonShapeOptions {
    SolidCellsOptions cells{};
    SamplingOptions sampling{};
    double max_speed_mps = 8.0;   // faster surfaces are slowed to this
    double rest_speed_mps = 0.1;  // below this, motion is taken for the flicker of the outline
    double max_period_s = 0.15;   // meshes further apart are two people, not one who moved
};

/// What one mesh of one person is to the physics: convex pieces, each with a velocity of its own.
struct PersonShape {
    SolidCells solid;                         // world frame, where the mesh was captured
    std::vector<Eigen::Vector3f> velocities;  // [m/s] one per piece
    std::shared_ptr<const std::vector<MovingSurfel>> surfels;  // never null
    std::shared_ptr<const SurfaceIndex> surface;
    double period_s = 0.0;  // since the mesh before; 0: there was none, and nothing moves
    Timestamp capture_time;
};

/// Turns the meshes of one person, which have nothing in common but the person, into shapes with
/// velocities.
///
/// Where a point of the surface was in the mesh before is taken to be the nearest point of that
/// mesh's surface that faces the same way. That tells the motion along the normal only; the
/// velocity of a piece is the least-squares solution over the points of its cell and, with less
/// weight, of the cells beside it. What no normal tells (a long arm moving along itself) comes out
/// as zero.
class PersonShaper {
public:
    explicit PersonShaper(const PersonShapeOptions& options);

    /// `mesh_world`: finite vertices, indices in range. Not thread-safe.
    PersonShape shape(const geometry::TriangleMesh& mesh_world, Timestamp capture_time);

    /// The next mesh is of a person who was not there before.
    void forget();

private:
    PersonShapeOptions options_;
    std::shared_ptr<const SurfaceIndex> previous_;
    Timestamp previous_time_;
};

}  // namespace atrium::physics
