#pragma once

#include "core/base/timestamp.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "world_server/physics/moving_surfel.hpp"
#include "world_server/physics/person_motion.hpp"
#include "world_server/physics/surface_index.hpp"

#include <Eigen/Core>

#include <memory>
#include <span>
#include <vector>

namespace atrium::physics {

struct PersonShapeOptions {
    SamplingOptions sampling{};
    MotionOptions motion{};
    double max_speed_mps = 10.0;   // faster surfaces are slowed to this
    double rest_speed_mps = 0.06;  // below this, motion is taken for the flicker of the outline
    double max_period_s = 0.15;    // meshes further apart are two people, not one who moved
};

/// What one mesh of one person is to the physics: a closed surface in samples that move.
struct PersonShape {
    std::shared_ptr<const std::vector<MovingSurfel>> surfels;  // never null
    double period_s = 0.0;  // since the mesh before; 0: there was none, and nothing moves
    Timestamp capture_time;
};

/// Turns the meshes of one person, which have nothing in common but the person, into surfels that
/// move from the surface of one mesh to that of the next.
class PersonShaper {
public:
    explicit PersonShaper(const PersonShapeOptions& options);

    /// `mesh_world`: finite vertices, indices in range. Not thread-safe.
    PersonShape shape(const geometry::TriangleMesh& mesh_world, Timestamp capture_time);

    /// The next mesh is of a person who was not there before.
    void forget();

private:
    std::vector<MovingSurfel> still_surfels(const SurfaceIndex& surface) const;
    std::vector<MovingSurfel> moving_surfels(const SurfaceIndex& surface, double period_s);
    void put_onto_previous(std::span<MovingSurfel> surfels) const;

    PersonShapeOptions options_;
    MotionEstimator motion_;
    std::vector<Eigen::Vector3f> displacements_;
    SurfaceIndex now_;  // scratch
    SurfaceIndex previous_;
    bool has_previous_ = false;
    Timestamp previous_time_;
};

}  // namespace atrium::physics
