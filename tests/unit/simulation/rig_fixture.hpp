#pragma once

#include "core/geometry/pinhole_camera.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace atrium::simulation {

inline geometry::CalibratedCamera camera_at(const Eigen::Vector3d& eye,
                                            const Eigen::Vector3d& target,
                                            double focal_px,
                                            int width,
                                            int height) {
    const Eigen::Vector3d forwards = (target - eye).normalized();
    const Eigen::Vector3d right = forwards.cross(Eigen::Vector3d::UnitZ()).normalized();
    Eigen::Matrix3d camera_from_site;
    camera_from_site.row(0) = right;
    camera_from_site.row(1) = forwards.cross(right);
    camera_from_site.row(2) = forwards;
    geometry::CalibratedCamera camera;
    camera.intrinsics = {.width = width,
                         .height = height,
                         .fx = focal_px,
                         .fy = focal_px,
                         .cx = 0.5 * (width - 1),
                         .cy = 0.5 * (height - 1)};
    camera.camera_from_site = {Eigen::Quaterniond(camera_from_site), -(camera_from_site * eye)};
    return camera;
}

/// Cameras on a circle of 3.1 m around the origin, alternately low and high. Camera 0 is on +Y, in
/// front of the person's face.
inline std::vector<geometry::CalibratedCamera> ring(int num_cameras,
                                                    int width = 320,
                                                    int height = 240) {
    std::vector<geometry::CalibratedCamera> cameras;
    for (int i = 0; i < num_cameras; ++i) {
        const double angle = std::numbers::pi * (0.5 + 2.0 * i / num_cameras);
        const Eigen::Vector3d eye(
            3.1 * std::cos(angle), 3.1 * std::sin(angle), i % 2 == 0 ? 1.1 : 2.5);
        cameras.push_back(camera_at(eye, {0.0, 0.0, 1.1}, 0.69 * width, width, height));
        cameras.back().name = "cam" + std::to_string(i);
    }
    return cameras;
}

}  // namespace atrium::simulation
