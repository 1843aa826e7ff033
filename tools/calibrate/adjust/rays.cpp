#include "tools/calibrate/adjust/rays.hpp"

#include <Eigen/LU>

#include <algorithm>

namespace atrium::calibrate {
namespace {

constexpr double kSameDirection_rad = 0.02;

}  // namespace

std::optional<SeenRay> seen_ray(const geometry::PinholeCamera& lens,
                                const geometry::RigidTransform& world_from_camera,
                                const Eigen::Vector2d& distorted_px) {
    const auto undistorted = lens.undistort(distorted_px);
    if (!undistorted) return std::nullopt;
    return SeenRay{world_from_camera.translation,
                   (world_from_camera.rotation * lens.ray_camera(*undistorted)).normalized(),
                   lens.fx};
}

std::optional<Eigen::Vector3d> nearest_to_rays(std::span<const SeenRay> rays) {
    double widest = 0.0;
    for (const SeenRay& ray : rays)
        widest = std::max(widest, ray.direction.cross(rays.front().direction).norm());
    if (rays.size() < 2 || widest < kSameDirection_rad) return std::nullopt;
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    // twice: distances count in pixels, for which the point must be known
    for (const bool is_first : {true, false}) {
        Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
        Eigen::Vector3d right = Eigen::Vector3d::Zero();
        for (const SeenRay& ray : rays) {
            const double px_per_m =
                is_first ? 1.0 : ray.focal_px / std::max(1e-3, (point - ray.start).norm());
            const Eigen::Matrix3d across =
                Eigen::Matrix3d::Identity() - ray.direction * ray.direction.transpose();
            sum += px_per_m * px_per_m * across;
            right += px_per_m * px_per_m * (across * ray.start);
        }
        point = sum.inverse() * right;
    }
    for (const SeenRay& ray : rays)
        if (ray.direction.dot(point - ray.start) <= 0.0) return std::nullopt;
    return point;
}

}  // namespace atrium::calibrate
