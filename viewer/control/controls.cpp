#include "viewer/control/controls.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

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
constexpr double kLowestM = 0.05;     // height of the lowest eye above the floor

// Height below which orbit, zoom and pan do not take the eye. An eye that flew below the floor is
// free there.
double lowest_m(double eye_z_m) {
    return eye_z_m < 0.0 ? -std::numeric_limits<double>::infinity() : std::min(kLowestM, eye_z_m);
}

// Tilts an arm from a target to an eye until it rises that much. An arm that is too short for it is
// as steep as it may be, and becomes longer.
Eigen::Vector3d raised(const Eigen::Vector3d& arm, double least_rise_m) {
    if (arm.z() >= least_rise_m) return arm;
    const double length = std::max(arm.norm(), least_rise_m / std::sin(kMaxElevationRad));
    const double flat_m = std::sqrt(length * length - least_rise_m * least_rise_m);
    const Eigen::Vector2d flat = flat_m * arm.head<2>().normalized();
    return {flat.x(), flat.y(), least_rise_m};
}

// Changes the length of an arm. Towards a target below the floor it stops at the floor.
Eigen::Vector3d zoomed(const Eigen::Vector3d& arm, double steps, double least_rise_m) {
    const Eigen::Vector3d direction = arm.normalized();
    double distance =
        std::clamp(arm.norm() * std::pow(kZoomPerStep, steps), kMinDistanceM, kMaxDistanceM);
    if (least_rise_m > 0.0) distance = std::max(distance, least_rise_m / direction.z());
    return raised(distance * direction, least_rise_m);
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
    const double floor_m = lowest_m(camera.position_m.z());
    const Eigen::Vector3d arm = camera.position_m - camera.target_m;
    if (motion.look_around || motion.walk)
        moved.target_m = moved.position_m - turned(arm, motion.turn_px);
    else
        moved.position_m = moved.target_m + turned(arm, motion.turn_px);

    if (motion.walk) return walked(motion, moved);
    const double least_rise_m = floor_m - moved.target_m.z();
    const Eigen::Vector3d to_eye = zoomed(
        raised(moved.position_m - moved.target_m, least_rise_m), motion.zoom_steps, least_rise_m);
    moved.position_m = moved.target_m + to_eye;
    // exact, because the next motion starts there
    moved.position_m.z() = std::max(moved.position_m.z(), floor_m);

    const Eigen::Vector3d forward = -to_eye.normalized();
    const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
    const Eigen::Vector3d up = right.cross(forward);
    Eigen::Vector3d pan =
        kPanPerPx * to_eye.norm() * (-motion.pan_px.x() * right + motion.pan_px.y() * up);
    pan.z() = std::max(pan.z(), floor_m - moved.position_m.z());
    const Eigen::Vector3d flight = kFlySpeedMPerS * motion.seconds *
                                   (motion.fly.x() * right + motion.fly.y() * forward +
                                    motion.fly.z() * Eigen::Vector3d::UnitZ());
    moved.position_m += pan;
    moved.position_m.z() = std::max(moved.position_m.z(), floor_m);
    moved.position_m += flight;
    moved.target_m += pan + flight;
    return moved;
}

}  // namespace atrium::viewer
