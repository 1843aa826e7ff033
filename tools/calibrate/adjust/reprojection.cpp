#include "tools/calibrate/adjust/reprojection.hpp"

#include <Eigen/Geometry>

#include <cmath>

namespace atrium::calibrate {
namespace {

constexpr double kNearest_m = 1e-6;

// OpenCV's distortion at (x, y, 1): radial factor and tangential shift.
struct Distortion {
    double r2, radial;
    Eigen::Vector2d shift;
};

Distortion distortion_at(const LensValues& lens, double x, double y) {
    const double r2 = x * x + y * y;
    return {r2,
            1.0 + r2 * (lens[3] + r2 * (lens[4] + r2 * lens[7])),
            {2.0 * lens[5] * x * y + lens[6] * (r2 + 2.0 * x * x),
             lens[5] * (r2 + 2.0 * y * y) + 2.0 * lens[6] * x * y}};
}

}  // namespace

std::optional<Eigen::Vector2d> project_in_camera(const LensValues& lens,
                                                 const Eigen::Vector3d& point_camera) {
    if (!(point_camera.z() > kNearest_m)) return std::nullopt;
    const double x = point_camera.x() / point_camera.z(), y = point_camera.y() / point_camera.z();
    const Distortion d = distortion_at(lens, x, y);
    return Eigen::Vector2d(lens[0] * (x * d.radial + d.shift.x()) + lens[1],
                           lens[0] * (y * d.radial + d.shift.y()) + lens[2]);
}

std::optional<Reprojection> reproject(const LensValues& lens, const Eigen::Vector3d& point_camera) {
    if (!(point_camera.z() > kNearest_m)) return std::nullopt;
    const double z = point_camera.z();
    const double x = point_camera.x() / z, y = point_camera.y() / z;
    const auto [r2, radial, shift] = distortion_at(lens, x, y);
    const double f = lens[0], p1 = lens[5], p2 = lens[6];
    const Eigen::Vector2d distorted(x * radial + shift.x(), y * radial + shift.y());
    Reprojection seen;
    seen.px = {f * distorted.x() + lens[1], f * distorted.y() + lens[2]};
    const double slope = lens[3] + r2 * (2.0 * lens[4] + 3.0 * r2 * lens[7]);  // radial by r2
    const double mixed = 2.0 * (x * y * slope + p1 * x + p2 * y);
    const double xx = radial + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x;
    const double yy = radial + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x;
    seen.by_point << xx, mixed, -(xx * x + mixed * y), mixed, yy, -(mixed * x + yy * y);
    seen.by_point *= f / z;
    const double r4 = r2 * r2, r6 = r4 * r2;
    seen.by_lens << distorted.x(), 1.0, 0.0, f * x * r2, f * x * r4, f * 2.0 * x * y,
        f * (r2 + 2.0 * x * x), f * x * r6, distorted.y(), 0.0, 1.0, f * y * r2, f * y * r4,
        f * (r2 + 2.0 * y * y), f * 2.0 * x * y, f * y * r6;
    return seen;
}

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
    Eigen::Matrix3d matrix;
    matrix << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
    return matrix;
}

TurnedPoint turn_by(const Eigen::Vector3d& rotation_vector, const Eigen::Vector3d& point) {
    const double angle2 = rotation_vector.squaredNorm(), angle = std::sqrt(angle2);
    // sin(a) / a, (1 - cos(a)) / a^2, (a - sin(a)) / a^3; their series where these cancel
    const bool is_small = angle < 1e-3;
    const double a = is_small ? 1.0 - angle2 / 6.0 : std::sin(angle) / angle;
    const double b = is_small ? 0.5 - angle2 / 24.0 : (1.0 - std::cos(angle)) / angle2;
    const double c = is_small ? 1.0 / 6.0 - angle2 / 120.0 : (1.0 - a) / angle2;
    const Eigen::Matrix3d cross = cross_matrix(rotation_vector);
    const Eigen::Matrix3d twice = cross * cross;
    TurnedPoint turned;
    turned.rotation = Eigen::Matrix3d::Identity() + a * cross + b * twice;
    turned.point = turned.rotation * point;
    // left Jacobian of the rotations
    turned.by_vector =
        -cross_matrix(turned.point) * (Eigen::Matrix3d::Identity() + b * cross + c * twice);
    return turned;
}

QuaternionTurned turn_by(const Eigen::Vector4d& xyzw, const Eigen::Vector3d& point) {
    const Eigen::Vector3d v = xyzw.head<3>();
    const double w = xyzw[3];
    const Eigen::Vector3d across = v.cross(point);
    QuaternionTurned turned;
    turned.point = point + 2.0 * (w * across + v.cross(across));
    turned.by_xyzw.leftCols<3>() =
        2.0 * (v.dot(point) * Eigen::Matrix3d::Identity() + v * point.transpose() -
               2.0 * point * v.transpose() - w * cross_matrix(point));
    turned.by_xyzw.col(3) = 2.0 * across;
    return turned;
}

}  // namespace atrium::calibrate
