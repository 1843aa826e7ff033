#include "core/geometry/alignment.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <cmath>

namespace atrium::geometry {

Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const double lengths = from.norm() * to.norm();
    if (!(lengths > 0.0)) return Eigen::Quaterniond::Identity();
    const Eigen::Vector3d across = from.cross(to);
    const double w = lengths + from.dot(to);
    constexpr double kOpposite = 1e-14;
    if (w > kOpposite * lengths)
        return Eigen::Quaterniond(w, across.x(), across.y(), across.z()).normalized();
    const Eigen::Vector3d axis = from.unitOrthogonal();
    return {0.0, axis.x(), axis.y(), axis.z()};
}

Eigen::Matrix3d rotation_of(const Eigen::Matrix3d& spread) {
    Eigen::Matrix4d sum;
    sum.topLeftCorner<3, 3>() =
        spread + spread.transpose() - spread.trace() * Eigen::Matrix3d::Identity();
    sum.topRightCorner<3, 1>() << spread(2, 1) - spread(1, 2), spread(0, 2) - spread(2, 0),
        spread(1, 0) - spread(0, 1);
    sum.bottomLeftCorner<1, 3>() = sum.topRightCorner<3, 1>().transpose();
    sum(3, 3) = spread.trace();
    const Eigen::Vector4d xyzw = principal_axes(Eigen::MatrixXd(sum)).axes.col(3);
    return Eigen::Quaterniond(xyzw).normalized().toRotationMatrix();
}

PrincipalAxes principal_axes(const Eigen::Matrix3d& symmetric) {
    const DynamicAxes found = principal_axes(Eigen::MatrixXd(symmetric));
    return {found.values, found.axes};
}

Eigen::Vector2d eigenvalues_of(const Eigen::Matrix2d& symmetric) {
    const double middle = 0.5 * symmetric.trace();
    const double half = std::hypot(0.5 * (symmetric(0, 0) - symmetric(1, 1)), symmetric(1, 0));
    return {middle - half, middle + half};
}

DynamicAxes principal_axes(const Eigen::MatrixXd& symmetric) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric);
    return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return a.ldlt().solve(b);
}

Eigen::VectorXd solve_least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
    return a.colPivHouseholderQr().solve(b);
}

}  // namespace atrium::geometry
