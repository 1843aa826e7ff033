#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

/// Rotations and axes that fit vectors. Eigen's decompositions, compiled once: each takes the
/// compiler seconds wherever it is used.
namespace atrium::geometry {

/// The shortest rotation that turns the direction of `from` into that of `to`. About any axis if
/// they are opposite; identity if one of them is zero.
Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// The rotation R that makes the sum of |to - R from|^2 smallest, for `spread`, the sum of `to *
/// from.transpose()` (Davenport 1968; Horn 1987). Of a matrix that is nearly a rotation, the
/// nearest one; of a sum of rotations, their mean.
Eigen::Matrix3d rotation_of(const Eigen::Matrix3d& spread);

/// Eigenvalues of a symmetric matrix, ascending, and its eigenvectors as columns.
struct PrincipalAxes {
    Eigen::Vector3d values;
    Eigen::Matrix3d axes;
};
PrincipalAxes principal_axes(const Eigen::Matrix3d& symmetric);

/// Eigenvalues of a symmetric matrix, ascending.
Eigen::Vector2d eigenvalues_of(const Eigen::Matrix2d& symmetric);

/// The same for any size.
struct DynamicAxes {
    Eigen::VectorXd values;
    Eigen::MatrixXd axes;
};
DynamicAxes principal_axes(const Eigen::MatrixXd& symmetric);

/// X of A X = B, for a symmetric positive semidefinite A.
Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// The x that makes |A x - b| smallest.
Eigen::VectorXd solve_least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

}  // namespace atrium::geometry
