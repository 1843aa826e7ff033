#pragma once

#include "core/geometry/pinhole_camera.hpp"

#include <Eigen/Core>

#include <array>

namespace atrium::camouflage {

/// Projects many points into the delivered picture of one camera, in single precision.
class CameraEye {
public:
    explicit CameraEye(const geometry::CalibratedCamera& camera);

    struct Place {
        Eigen::Vector2f px = Eigen::Vector2f::Zero();  // distorted
        float depth_m = 0.0F;                          // along the axis
        bool is_in_picture = false;
    };
    Place place_of(const Eigen::Vector3f& point_site) const;

    /// The point at this depth behind a pixel whose direction is `ray_camera`, (x, y, 1).
    Eigen::Vector3f point_site(const Eigen::Vector3f& ray_camera, float depth_m) const {
        return centre_ + depth_m * (site_from_camera_ * ray_camera);
    }
    /// Direction of a pixel of the delivered picture; zero where the lens has no inverse.
    Eigen::Vector3f ray_camera(const Eigen::Vector2f& px) const;

    /// Size of its pictures: even, as site pictures are.
    int width() const { return width_; }
    int height() const { return height_; }
    const Eigen::Vector3f& centre_site() const { return centre_; }
    float focal_px() const { return fx_; }

private:
    geometry::PinholeCamera lens_;
    Eigen::Matrix3f camera_from_site_;
    Eigen::Matrix3f site_from_camera_;
    Eigen::Vector3f translation_;
    Eigen::Vector3f centre_;
    float fx_ = 0.0F;
    float fy_ = 0.0F;
    float skew_ = 0.0F;
    Eigen::Vector2f middle_;
    std::array<float, 5> distortion_{};
    int width_ = 0;
    int height_ = 0;
    float most_x_ = 0.0F;  // |x / z| and |y / z| farther out are not in the picture
    float most_y_ = 0.0F;
};

}  // namespace atrium::camouflage
