#pragma once

#include "core/geometry/rigid_transform.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <string>

namespace atrium::calibrate {

/// Rotation and vector of a camera, as they stand in a file.
struct ForeignPose {
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    Eigen::Vector3d vector = Eigen::Vector3d::Zero();
};

/// What the rotation and the vector of a file mean.
struct Reading {
    enum class Pose : std::uint8_t {
        kCameraFromSite,       // p_camera = rotation * p_site + vector
        kSiteFromCamera,       // p_site = rotation * p_camera + vector
        kRotationAndPosition,  // p_camera = rotation * (p_site - vector)
        /// p_camera = rotation^T * p_site + vector: MATLAB's matrices are for row vectors
        kTransposed,
    };
    Pose pose = Pose::kCameraFromSite;
    /// The cameras look along their -Z with +Y up, as in OpenGL, not along +Z with +Y down.
    bool opengl = false;

    bool operator==(const Reading&) const = default;
};

inline constexpr std::array<Reading, 7> kReadings{{{Reading::Pose::kCameraFromSite, false},
                                                   {Reading::Pose::kSiteFromCamera, false},
                                                   {Reading::Pose::kRotationAndPosition, false},
                                                   {Reading::Pose::kCameraFromSite, true},
                                                   {Reading::Pose::kSiteFromCamera, true},
                                                   {Reading::Pose::kRotationAndPosition, true},
                                                   {Reading::Pose::kTransposed, false}}};

/// `pose.rotation` must be a rotation.
geometry::RigidTransform camera_from_site(const ForeignPose& pose, const Reading& reading);

/// The true pose if the frames of the room and of the camera (+X right, +Y up, +Z ahead) of a pose
/// are left-handed: mirrors +X of the room and +Y of the camera. The axis that is up keeps its name
/// unless it is X. Inverse of itself.
geometry::RigidTransform mirrored(const geometry::RigidTransform& camera_from_site);

/// The pose that a file with this reading must hold. Inverse of the above.
ForeignPose foreign_pose(const geometry::RigidTransform& camera_from_site, const Reading& reading);

/// For messages: "the poses are site_from_camera, with the axes of OpenGL".
std::string describe(const Reading& reading);

/// The options that say it: "--direction position --axes opengl".
const char* option_of(const Reading& reading);

}  // namespace atrium::calibrate
