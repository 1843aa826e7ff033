#include "core/geometry/alignment.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>

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
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(spread, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix3d sign = Eigen::Matrix3d::Identity();
    if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0) sign(2, 2) = -1.0;
    return svd.matrixU() * sign * svd.matrixV().transpose();
}

PrincipalAxes principal_axes(const Eigen::Matrix3d& symmetric) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(symmetric);
    return {solver.eigenvalues(), solver.eigenvectors()};
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
