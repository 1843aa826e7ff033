#include "viewer/control/controls.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace atrium::viewer {
namespace {

constexpr double kTurnRadPerPx = 0.006;
constexpr double kMaxElevationRad = 1.5;  // 86 degrees
constexpr double kZoomPerStep = 0.88;
constexpr double kMinDistanceM = 0.2;
constexpr double kMaxDistanceM = 50.0;
constexpr double kFlySpeedMPerS = 1.8;
constexpr double kWalkSpeedMPerS = 1.4;
constexpr double kEyesM = 1.65;       // eye height while walking
constexpr double kPanPerPx = 0.0015;  // share of the distance to the target
constexpr double kLowestM = 0.05;     // lowest eye that orbits and zooms above the floor

// Tilts an arm from a target to an eye so that the eye stays above the floor.
Eigen::Vector3d above_floor(const Eigen::Vector3d& arm, double target_z_m) {
    const double length = arm.norm();
    const double least_rise_m = std::min(kLowestM - target_z_m, 0.99 * length);
    if (arm.z() >= least_rise_m) return arm;
    const double flat_m = std::sqrt(length * length - least_rise_m * least_rise_m);
    const Eigen::Vector2d flat = flat_m * arm.head<2>().normalized();
    return {flat.x(), flat.y(), least_rise_m};
}

Eigen::Vector3d turned(const Eigen::Vector3d& arm, const Eigen::Vector2d& turn_px) {
    const double length = arm.norm();
    const double azimuth = std::atan2(arm.y(), arm.x()) - kTurnRadPerPx * turn_px.x();
    const double elevation =
        std::clamp(std::asin(std::clamp(arm.z() / length, -1.0, 1.0)) + kTurnRadPerPx * turn_px.y(),
                   -kMaxElevationRad,
                   kMaxElevationRad);
    return length * Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                                    std::cos(elevation) * std::sin(azimuth),
                                    std::sin(elevation));
}

renderer::ViewCamera walked(const Motion& motion, renderer::ViewCamera camera) {
    Eigen::Vector3d ahead = camera.target_m - camera.position_m;
    ahead.z() = 0.0;
    ahead.normalize();  // not zero: the eye is never above or below the target
    const Eigen::Vector3d right = ahead.cross(Eigen::Vector3d::UnitZ());
    Eigen::Vector3d shift =
        kWalkSpeedMPerS * motion.seconds * (motion.fly.x() * right + motion.fly.y() * ahead);
    shift.z() = kEyesM - camera.position_m.z();
    camera.position_m += shift;
    camera.target_m += shift;
    return camera;
}

}  // namespace

renderer::ViewCamera apply(const Motion& motion, const renderer::ViewCamera& camera) {
    renderer::ViewCamera moved = camera;
    // an eye that flew below the floor, or looks at something there, may stay there
    const bool stays_above =
        !motion.look_around && camera.position_m.z() >= kLowestM && camera.target_m.z() >= kLowestM;
    const Eigen::Vector3d arm = camera.position_m - camera.target_m;
    if (motion.look_around || motion.walk)
        moved.target_m = moved.position_m - turned(arm, motion.turn_px);
    else
        moved.position_m = moved.target_m + turned(arm, motion.turn_px);

    if (motion.walk) return walked(motion, moved);
    Eigen::Vector3d to_eye = moved.position_m - moved.target_m;
    const double distance = std::clamp(
        to_eye.norm() * std::pow(kZoomPerStep, motion.zoom_steps), kMinDistanceM, kMaxDistanceM);
    to_eye = distance * to_eye.normalized();
    if (stays_above) to_eye = above_floor(to_eye, moved.target_m.z());
    moved.position_m = moved.target_m + to_eye;

    const Eigen::Vector3d forward = -to_eye.normalized();
    const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
    const Eigen::Vector3d up = right.cross(forward);
    const Eigen::Vector3d shift =
        kPanPerPx * distance * (-motion.pan_px.x() * right + motion.pan_px.y() * up) +
        kFlySpeedMPerS * motion.seconds *
            (motion.fly.x() * right + motion.fly.y() * forward +
             motion.fly.z() * Eigen::Vector3d::UnitZ());
    moved.position_m += shift;
    moved.target_m += shift;
    return moved;
}

}  // namespace atrium::viewer
