#pragma once

#include "core/base/executor.hpp"
#include "core/base/timestamp.hpp"
#include "core/geometry/motion_field.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "site_node/motion/camera_evidence.hpp"
#include "site_node/motion/motion_options.hpp"
#include "site_node/motion/motion_picture.hpp"
#include "site_node/motion/surface_points.hpp"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace atrium::motion {

/// Finds how a surface moves from the pictures of calibrated cameras, including motion along itself
/// that no outline shows.
///
/// 1. Dense flow between two successive pictures of each camera (DenseFlow), at a quarter of their
///    resolution.
/// 2. Points of the surface, and the cameras that see them (DepthMap).
/// 3. The surface in each cell of a lattice moves as one piece. Its displacement and rotation solve
///    `px_per_m * displacement = flow` over its points and cameras, weighted by the texture of the
///    patch around each point in each direction, and robustly. Cells share the equations of the
///    cells around them unless they move differently. Directions without texture thus follow their
///    surroundings, and without any they are damped towards rest.
/// 4. Further rounds compare the patches themselves at the places that the motion predicts (Lucas,
///    Kanade, "An Iterative Image Registration Technique", 1981, for all cameras at once). They
///    correct the flow and tell where it is wrong.
///
/// Petit et al., "Surface Flow from Visual Cues", 2011, also lift flow to a surface; there the
/// vertices of one mesh move under a Laplacian, here cells of a lattice do, since successive hulls
/// have no common vertices.
class SurfaceMotion {
public:
    SurfaceMotion(std::span<const geometry::CalibratedCamera> cameras,
                  const SurfaceMotionOptions& options = {});

    /// Finds the motion of `mesh_site` at its capture. `pictures`: one per camera, of that instant;
    /// empty where the camera sees nobody or delivered nothing. They are exchanged with those of
    /// the call before. `out` is empty if there were none, or if `max_period_s` has passed.
    /// Vertices must be finite. Deterministic for any number of workers.
    void estimate(const geometry::TriangleMesh& mesh_site,
                  std::vector<MotionPicture>& pictures,
                  Timestamp capture_time,
                  Executor& executor,
                  geometry::MotionField& out);

    /// Treats the next pictures as the first.
    void forget() { has_before_ = false; }

    std::size_t num_points() const { return surface_.points.size(); }
    std::size_t num_sights() const;

private:
    using Matrix6 = Eigen::Matrix<double, 6, 6>;
    using Vector6 = Eigen::Matrix<double, 6, 1>;
    struct Cell {
        // about the common origin: displacement there, then rotation
        Matrix6 lhs;
        Vector6 rhs;
        double seen = 0.0;
        double explained = 0.0;
        Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  // of the centre
        Eigen::Vector3d turn = Eigen::Vector3d::Zero();
        float confidence = 0.0F;

        Eigen::Vector3d displacement_at(const Eigen::Vector3d& from_centre) const {
            return displacement + turn.cross(from_centre);
        }
    };
    struct Neighbour {
        std::uint32_t cell = 0;
        double nearness = 0.0;
    };

    void link_cells();
    void collect(std::size_t cell, int round);
    void solve(std::size_t cell, int round, Cell& solved) const;
    void write(double period_s, geometry::MotionField& out);

    SurfaceMotionOptions options_;
    std::vector<CameraEvidence> cameras_;
    std::vector<MotionPicture> before_;
    Timestamp before_time_;
    bool has_before_ = false;
    SurfacePoints surface_;
    Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
    std::vector<Cell> cells_;
    std::vector<Cell> solved_;  // scratch
    std::vector<std::vector<Neighbour>> neighbours_;
    std::vector<geometry::MotionCell> found_;
};

}  // namespace atrium::motion
