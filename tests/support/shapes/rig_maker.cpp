#include "tests/support/shapes/rig_maker.hpp"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace atrium::test {

geometry::RigidTransform look_at(const Eigen::Vector3d& centre_site,
                                 const Eigen::Vector3d& target_site) {
    const Eigen::Vector3d forward = (target_site - centre_site).normalized();
    const Eigen::Vector3d up =
        std::abs(forward.z()) < 0.99 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
    const Eigen::Vector3d right = forward.cross(up).normalized();
    Eigen::Matrix3d camera_from_site;
    camera_from_site << right.transpose(), forward.cross(right).transpose(), forward.transpose();
    const Eigen::Quaterniond rotation = Eigen::Quaterniond(camera_from_site).normalized();
    return {rotation, -(rotation * centre_site)};
}

std::vector<geometry::CalibratedCamera> make_ring_rig(const RingRigOptions& options) {
    std::vector<geometry::CalibratedCamera> rig;
    for (int i = 0; i < options.num_cameras; ++i) {
        const double angle =
            options.first_angle_rad + 2.0 * std::numbers::pi * i / options.num_cameras;
        const double height =
            options.heights_m[static_cast<std::size_t>(i) % options.heights_m.size()];
        geometry::CalibratedCamera camera;
        camera.name = "cam" + std::to_string(i);
        camera.intrinsics.width = camera.intrinsics.height = options.size_px;
        camera.intrinsics.fx = camera.intrinsics.fy = options.focal_px;
        camera.intrinsics.cx = camera.intrinsics.cy = 0.5 * (options.size_px - 1);
        camera.camera_from_site = look_at(
            {options.radius_m * std::cos(angle), options.radius_m * std::sin(angle), height},
            options.target_site);
        rig.push_back(camera);
    }
    return rig;
}

}  // namespace atrium::test
