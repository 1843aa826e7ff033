#include "core/geometry/pinhole_camera.hpp"

#include <Eigen/LU>

#include <cmath>

namespace atrium::geometry {
namespace {

struct Distorted {
    Eigen::Vector2d value;
    Eigen::Matrix2d jacobian;
};

// Brown's distortion model in OpenCV's form, on the normalised plane.
Distorted distort_normalised(const std::array<double, 5>& coefficients, const Eigen::Vector2d& p) {
    const auto [k1, k2, p1, p2, k3] = coefficients;
    const double x = p.x();
    const double y = p.y();
    const double r2 = x * x + y * y;
    const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
    const double radial_slope =
        2.0 * (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3));  // d radial / d r2, times 2
    Distorted result;
    result.value = {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
                    y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
    result.jacobian(0, 0) = radial + x * x * radial_slope + 2.0 * p1 * y + 6.0 * p2 * x;
    result.jacobian(0, 1) = x * y * radial_slope + 2.0 * p1 * x + 2.0 * p2 * y;
    result.jacobian(1, 0) = result.jacobian(0, 1);
    result.jacobian(1, 1) = radial + y * y * radial_slope + 6.0 * p1 * y + 2.0 * p2 * x;
    return result;
}

}  // namespace

Eigen::Vector2d PinholeCamera::distort(const Eigen::Vector2d& undistorted_px) const {
    if (!has_distortion()) return undistorted_px;
    const Eigen::Vector3d ray = ray_camera(undistorted_px);
    const Eigen::Vector2d d = distort_normalised(distortion, ray.head<2>()).value;
    return {fx * d.x() + skew * d.y() + cx, fy * d.y() + cy};
}

std::optional<Eigen::Vector2d> PinholeCamera::undistort(const Eigen::Vector2d& distorted_px) const {
    if (!has_distortion()) return distorted_px;
    const Eigen::Vector2d target = ray_camera(distorted_px).head<2>();
    Eigen::Vector2d p = target;
    constexpr int kMaxSteps = 30;
    constexpr double kConverged = 1e-12;  // on the normalised plane: 1e-9 px at f = 1000 px
    for (int step = 0; step < kMaxSteps; ++step) {
        const Distorted d = distort_normalised(distortion, p);
        const Eigen::Vector2d residual = target - d.value;
        // beyond the fold of the radial polynomial the determinant changes sign and the ray is not
        // unique
        if (!(d.jacobian.determinant() > 0.0)) return std::nullopt;
        if (residual.cwiseAbs().maxCoeff() < kConverged) {
            return Eigen::Vector2d{fx * p.x() + skew * p.y() + cx, fy * p.y() + cy};
        }
        p += d.jacobian.inverse() * residual;
    }
    return std::nullopt;
}

}  // namespace atrium::geometry
