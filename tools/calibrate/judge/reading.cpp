#include "tools/calibrate/judge/reading.hpp"

namespace atrium::calibrate {
namespace {

// Half a turn around X takes the axes of OpenGL into ours, and back.
geometry::RigidTransform half_turn() {
    return {Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0), Eigen::Vector3d::Zero()};
}

}  // namespace

geometry::RigidTransform camera_from_site(const ForeignPose& pose, const Reading& reading) {
    Eigen::Quaterniond rotation = Eigen::Quaterniond(pose.rotation).normalized();
    if (reading.pose == Reading::Pose::kTransposed) rotation = rotation.conjugate();
    geometry::RigidTransform result{rotation, pose.vector};
    if (reading.pose == Reading::Pose::kSiteFromCamera) result = result.inverse();
    if (reading.pose == Reading::Pose::kRotationAndPosition)
        result.translation = -(rotation * pose.vector);
    return reading.opengl ? half_turn() * result : result;
}

geometry::RigidTransform mirrored(const geometry::RigidTransform& camera_from_site) {
    const Eigen::Vector3d of_camera(1.0, -1.0, 1.0);
    const Eigen::Vector3d of_site(-1.0, 1.0, 1.0);
    const Eigen::Matrix3d rotation = of_camera.asDiagonal() *
                                     camera_from_site.rotation.toRotationMatrix() *
                                     of_site.asDiagonal();
    return {Eigen::Quaterniond(rotation), of_camera.cwiseProduct(camera_from_site.translation)};
}

ForeignPose foreign_pose(const geometry::RigidTransform& camera_from_site, const Reading& reading) {
    const geometry::RigidTransform ours =
        reading.opengl ? half_turn() * camera_from_site : camera_from_site;
    const geometry::RigidTransform inverse = ours.inverse();
    switch (reading.pose) {
        case Reading::Pose::kCameraFromSite:
            break;
        case Reading::Pose::kSiteFromCamera:
            return {inverse.rotation.toRotationMatrix(), inverse.translation};
        case Reading::Pose::kRotationAndPosition:
            return {ours.rotation.toRotationMatrix(), inverse.translation};
        case Reading::Pose::kTransposed:
            return {inverse.rotation.toRotationMatrix(), ours.translation};
    }
    return {ours.rotation.toRotationMatrix(), ours.translation};
}

std::string describe(const Reading& reading) {
    std::string text;
    switch (reading.pose) {
        case Reading::Pose::kCameraFromSite:
            text = "camera_from_site (p_camera = R p_site + t)";
            break;
        case Reading::Pose::kSiteFromCamera:
            text = "site_from_camera (p_site = R p_camera + t)";
            break;
        case Reading::Pose::kRotationAndPosition:
            text = "a rotation camera_from_site with the camera's position";
            break;
        case Reading::Pose::kTransposed:
            text =
                "camera_from_site with a transposed rotation, as of MATLAB (p_camera = R^T "
                "p_site + t)";
            break;
    }
    return text + (reading.opengl ? ", with the axes of OpenGL (-Z ahead, +Y up)"
                                  : ", with the axes of OpenCV (+Z ahead, +Y down)");
}

const char* option_of(const Reading& reading) {
    switch (reading.pose) {
        case Reading::Pose::kCameraFromSite:
            return reading.opengl ? "--direction camera_from_site --axes opengl"
                                  : "--direction camera_from_site --axes opencv";
        case Reading::Pose::kSiteFromCamera:
            return reading.opengl ? "--direction site_from_camera --axes opengl"
                                  : "--direction site_from_camera --axes opencv";
        case Reading::Pose::kTransposed:
            return reading.opengl ? "--direction transposed --axes opengl"
                                  : "--direction transposed --axes opencv";
        case Reading::Pose::kRotationAndPosition:
            break;
    }
    return reading.opengl ? "--direction position --axes opengl"
                          : "--direction position --axes opencv";
}

}  // namespace atrium::calibrate
