#include "site_node/camouflage/camera_eye.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::camouflage {

CameraEye::CameraEye(const geometry::CalibratedCamera& camera)
    : lens_(camera.intrinsics),
      camera_from_site_(camera.camera_from_site.rotation.toRotationMatrix().cast<float>()),
      site_from_camera_(camera_from_site_.transpose()),
      translation_(camera.camera_from_site.translation.cast<float>()),
      centre_(camera.centre_site().cast<float>()),
      fx_(static_cast<float>(lens_.fx)),
      fy_(static_cast<float>(lens_.fy)),
      skew_(static_cast<float>(lens_.skew)),
      middle_(Eigen::Vector2d(lens_.cx, lens_.cy).cast<float>()),
      width_(lens_.width & ~1),
      height_(lens_.height & ~1) {
    std::ranges::transform(
        lens_.distortion, distortion_.begin(), [](double k) { return static_cast<float>(k); });
    // a lens model bends far points back into the picture
    constexpr float kMargin = 1.1F;
    const Eigen::Array2d last(lens_.width - 1, lens_.height - 1);
    for (const double across : {0.0, 0.5, 1.0}) {
        for (const double along : {0.0, 0.5, 1.0}) {
            const Eigen::Vector3f ray =
                ray_camera((last * Eigen::Array2d(across, along)).matrix().cast<float>());
            most_x_ = std::max(most_x_, kMargin * std::abs(ray.x()));
            most_y_ = std::max(most_y_, kMargin * std::abs(ray.y()));
        }
    }
}

Eigen::Vector3f CameraEye::ray_camera(const Eigen::Vector2f& px) const {
    const auto straight = lens_.undistort(px.cast<double>());
    if (!straight) return Eigen::Vector3f::Zero();
    return lens_.ray_camera(*straight).cast<float>();
}

CameraEye::Place CameraEye::place_of(const Eigen::Vector3f& point_site) const {
    constexpr float kNearest_m = 0.05F;
    const Eigen::Vector3f at = camera_from_site_ * point_site + translation_;
    Place place;
    place.depth_m = at.z();
    if (!(at.z() > kNearest_m)) return place;
    const float x = at.x() / at.z();
    const float y = at.y() / at.z();
    if (!(std::abs(x) <= most_x_ && std::abs(y) <= most_y_)) return place;
    const std::array<float, 5>& k = distortion_;
    const float r2 = x * x + y * y;
    const float radial = 1.0F + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
    const float bent_x = x * radial + 2.0F * k[2] * x * y + k[3] * (r2 + 2.0F * x * x);
    const float bent_y = y * radial + k[2] * (r2 + 2.0F * y * y) + 2.0F * k[3] * x * y;
    place.px = middle_ + Eigen::Vector2f(fx_ * bent_x + skew_ * bent_y, fy_ * bent_y);
    place.is_in_picture = place.px.x() > -0.5F && place.px.y() > -0.5F &&
                          place.px.x() < static_cast<float>(width_) - 0.5F &&
                          place.px.y() < static_cast<float>(height_) - 0.5F;
    return place;
}

}  // namespace atrium::camouflage
