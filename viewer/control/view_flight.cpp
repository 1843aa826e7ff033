#include "viewer/control/view_flight.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace atrium::viewer {
namespace {

// Arm from the target to the eye.
struct Arm {
    double azimuth = 0.0;
    double elevation = 0.0;
    double length = 1.0;
};

Arm arm_of(const renderer::ViewCamera& camera) {
    const Eigen::Vector3d arm = camera.position_m - camera.target_m;
    const double length = std::max(arm.norm(), 1e-3);
    return {
        std::atan2(arm.y(), arm.x()), std::asin(std::clamp(arm.z() / length, -1.0, 1.0)), length};
}

}  // namespace

renderer::ViewCamera between(const renderer::ViewCamera& from,
                             const renderer::ViewCamera& to,
                             double share) {
    if (share <= 0.0) return from;
    if (share >= 1.0) return to;
    const Arm a = arm_of(from);
    const Arm b = arm_of(to);
    const double turn = std::remainder(b.azimuth - a.azimuth, 2.0 * std::numbers::pi);
    const double azimuth = a.azimuth + share * turn;
    const double elevation = a.elevation + share * (b.elevation - a.elevation);
    const double length = a.length * std::pow(b.length / a.length, share);
    renderer::ViewCamera camera = from;
    camera.target_m += share * (to.target_m - from.target_m);
    camera.position_m =
        camera.target_m + length * Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                                                   std::cos(elevation) * std::sin(azimuth),
                                                   std::sin(elevation));
    camera.fov_deg += share * (to.fov_deg - from.fov_deg);
    return camera;
}

renderer::ViewCamera ViewFlight::update(const renderer::ViewCamera& camera, Clock::time_point now) {
    if (!flight_) return camera;
    const double passed = std::chrono::duration<double>(now - flight_->since) / kDuration;
    const double share = std::clamp(passed, 0.0, 1.0);
    const double smooth = share * share * (3.0 - 2.0 * share);
    const renderer::ViewCamera at = between(flight_->from, flight_->to, smooth);
    if (share >= 1.0) flight_.reset();
    return at;
}

}  // namespace atrium::viewer
