#include "core/geometry/alignment.hpp"
#include "tools/calibrate/refine/refine.hpp"

#include <Eigen/Geometry>

#include <cmath>

namespace atrium::calibrate {
namespace {

constexpr double kStays_m = 0.002;
constexpr double kStays_rad = 0.001;
constexpr int kLayings = 60;

// Small turn, motion and growth of the whole room, about its middle.
using Similarity = Eigen::Matrix<double, 7, 1>;

double weight(double distance) { return 1.0 / (1.0 + distance * distance); }

}  // namespace

std::vector<geometry::CalibratedCamera> laid_on(std::vector<geometry::CalibratedCamera> cameras,
                                                std::span<const geometry::CalibratedCamera> like) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const auto& camera : cameras)
        middle += camera.centre_site() / static_cast<double>(cameras.size());
    for (int i = 0; i < kLayings; ++i) {
        Eigen::Matrix<double, 7, 7> normal = Eigen::Matrix<double, 7, 7>::Identity() * 1e-6;
        Similarity right = Similarity::Zero();
        const auto add = [&](const Eigen::Matrix<double, 3, 7>& by, const Eigen::Vector3d& error) {
            const double w = weight(error.norm());
            normal += w * by.transpose() * by;
            right += w * by.transpose() * error;
        };
        for (std::size_t c = 0; c < cameras.size(); ++c) {
            const Eigen::Vector3d arm = cameras[c].centre_site() - middle;
            Eigen::Matrix<double, 3, 7> by = Eigen::Matrix<double, 3, 7>::Zero();
            for (int axis = 0; axis < 3; ++axis)
                by.col(axis) = Eigen::Vector3d::Unit(axis).cross(arm) / kStays_m;
            by.block<3, 3>(0, 3) = Eigen::Matrix3d::Identity() / kStays_m;
            by.col(6) = arm / kStays_m;
            add(by, (like[c].centre_site() - cameras[c].centre_site()) / kStays_m);
            const Eigen::AngleAxisd turn(like[c].camera_from_site.rotation.conjugate() *
                                         cameras[c].camera_from_site.rotation);
            by.setZero();
            by.block<3, 3>(0, 0) = Eigen::Matrix3d::Identity() / kStays_rad;
            add(by, turn.angle() * turn.axis() / kStays_rad);
        }
        const Similarity step = geometry::solve_symmetric(normal, right);
        const Eigen::Vector3d turn = step.head<3>();
        const Eigen::Quaterniond rotation =
            turn.norm() > 0.0
                ? Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized()))
                : Eigen::Quaterniond::Identity();
        for (auto& camera : cameras) {
            geometry::RigidTransform pose = camera.camera_from_site.inverse();
            pose.translation = middle + step.segment<3>(3) +
                               (1.0 + step[6]) * (rotation * (pose.translation - middle));
            pose.rotation = (rotation * pose.rotation).normalized();
            camera.camera_from_site = pose.inverse();
        }
        middle += step.segment<3>(3);
    }
    return cameras;
}

}  // namespace atrium::calibrate
