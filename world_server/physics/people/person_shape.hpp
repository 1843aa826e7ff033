#pragma once

#include "core/base/timestamp.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "world_server/physics/options/people_options.hpp"
#include "world_server/physics/people/moving_surfel.hpp"
#include "world_server/physics/people/person_motion.hpp"
#include "world_server/physics/people/surface_index.hpp"

#include <Eigen/Core>

#include <memory>
#include <span>
#include <vector>

namespace atrium::physics {

/// The surface of one mesh of a person, as samples that move.
struct PersonShape {
    std::shared_ptr<const std::vector<MovingSurfel>> surfels;  // never null
    double period_s = 0.0;  // time since the previous mesh; 0: no previous mesh, nothing moves
    Timestamp capture_time;
    Timestamp delays_from;  // start of its latencies: its capture, or when a recording was played
};

/// Converts successive meshes of one person into surfels that move from each surface to the next.
/// The meshes need no common vertices.
class PersonShaper {
public:
    explicit PersonShaper(const PersonShapeOptions& options);

    /// `mesh_world` must have finite vertices and valid indices. Not thread-safe.
    PersonShape shape(const geometry::TriangleMesh& mesh_world, Timestamp capture_time);

    /// Treats the next mesh as that of a new person.
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
