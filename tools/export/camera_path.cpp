#include "tools/export/camera_path.hpp"

#include <Eigen/Geometry>

#include <numbers>

namespace atrium::exporting {

geometry::RigidTransform look_at(const Eigen::Vector3d& position_m,
                                 const Eigen::Vector3d& target_m) {
    const Eigen::Vector3d forward = (target_m - position_m).normalized();
    Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ());
    if (right.norm() < 1e-6) right = Eigen::Vector3d::UnitX();  // straight up or down
    right.normalize();
    Eigen::Matrix3d rotation;
    rotation << right, forward.cross(right), forward;
    return {Eigen::Quaterniond(rotation), position_m};
}

CameraPath sample_path(const recording::ViewPath& path,
                       const Survey& survey,
                       Timestamp recording_begin,
                       const geometry::RigidTransform& frame_from_world) {
    CameraPath result;
    for (std::size_t i = 0; i < survey.frames.size(); ++i) {
        const recording::ViewKey key = path.at(survey.frames[i].recorded - recording_begin);
        if (i == 0) result.fov_rad = key.fov_deg * std::numbers::pi / 180.0;
        result.keys.push_back(
            {survey.time_s(i), frame_from_world * look_at(key.position_m, key.target_m)});
    }
    return result;
}

}  // namespace atrium::exporting
