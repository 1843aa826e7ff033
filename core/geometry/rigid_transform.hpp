#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace atrium::geometry {

/// Rigid transform: `p_world = world_from_camera * p_camera`. In a product adjacent names match:
/// `world_from_camera = world_from_site * site_from_camera`.
struct RigidTransform {
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  // unit length
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();         // [m]

    Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
        return rotation * point + translation;
    }

    RigidTransform operator*(const RigidTransform& right) const {
        return {(rotation * right.rotation).normalized(),
                rotation * right.translation + translation};
    }

    /// `camera_from_world = world_from_camera.inverse()`.
    RigidTransform inverse() const {
        const Eigen::Quaterniond back = rotation.conjugate();
        return {back, -(back * translation)};
    }

    Eigen::Matrix4d matrix() const {
        Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
        m.topLeftCorner<3, 3>() = rotation.toRotationMatrix();
        m.topRightCorner<3, 1>() = translation;
        return m;
    }
};

}  // namespace atrium::geometry
