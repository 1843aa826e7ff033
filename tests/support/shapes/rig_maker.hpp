#pragma once

#include "core/geometry/pinhole_camera.hpp"

#include <Eigen/Core>

#include <vector>

namespace atrium::test {

/// A camera at `centre` that looks at `target`, with the picture upright along +Z (or +Y if it
/// looks along Z).
geometry::RigidTransform look_at(const Eigen::Vector3d& centre_site,
                                 const Eigen::Vector3d& target_site);

struct RingRigOptions {
    int num_cameras = 8;
    double radius_m = 3.0;
    std::vector<double> heights_m{1.1, 2.4};  // used in turn
    Eigen::Vector3d target_site{0.0, 0.0, 0.9};
    double first_angle_rad = 0.0;
    int size_px = 1000;
    double focal_px = 1300.0;
};

/// Cameras "cam0", "cam1", ... evenly spaced on a circle around the Z axis.
std::vector<geometry::CalibratedCamera> make_ring_rig(const RingRigOptions& options);

}  // namespace atrium::test
