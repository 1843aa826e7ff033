#include "core/geometry/alignment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace atrium::geometry {
namespace {

class Alignment : public testing::Test {
protected:
    double number() { return std::normal_distribution<double>()(random_); }
    Eigen::Vector3d vector() { return {number(), number(), number()}; }
    Eigen::Quaterniond rotation() {
        return Eigen::Quaterniond(number(), number(), number(), number()).normalized();
    }
    std::mt19937 random_{7};
};

TEST_F(Alignment, RotationBetweenIsTheShortest) {
    for (int i = 0; i < 200; ++i) {
        const Eigen::Vector3d a = vector(), b = std::exp(number()) * vector();
        const Eigen::Quaterniond turn = rotation_between(a, b);
        EXPECT_NEAR(turn.norm(), 1.0, 1e-12);
        EXPECT_LT(((turn * a).normalized() - b.normalized()).norm(), 1e-12);
        const double angle = std::acos(a.normalized().dot(b.normalized()));
        EXPECT_NEAR(Eigen::AngleAxisd(turn).angle(), angle, 1e-7);
    }
}

TEST_F(Alignment, RotationBetweenNearlyOppositeAndNoDirections) {
    for (int i = 0; i < 100; ++i) {
        const Eigen::Vector3d a = vector();
        for (const double off : {0.0, 1e-16, 1e-12, 1e-8, 1e-4}) {
            const Eigen::Vector3d b = -2.0 * a + off * vector();
            const Eigen::Quaterniond turn = rotation_between(a, b);
            EXPECT_NEAR(turn.norm(), 1.0, 1e-12);
            EXPECT_LT(((turn * a).normalized() - b.normalized()).norm(), 3e-7) << off;
        }
        EXPECT_TRUE(
            rotation_between(a, Eigen::Vector3d::Zero()).isApprox(Eigen::Quaterniond::Identity()));
    }
}

TEST_F(Alignment, RotationOfSpreadIsThatOfThePoints) {
    for (int i = 0; i < 100; ++i) {
        const Eigen::Matrix3d truth = rotation().toRotationMatrix();
        Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
        const int num = 2 + i % 5;  // two directions determine it
        for (int k = 0; k < num; ++k) {
            const Eigen::Vector3d from = vector();
            spread += truth * from * from.transpose();
        }
        EXPECT_LT((rotation_of(spread) - truth).norm(), 1e-9);
    }
}

TEST_F(Alignment, RotationOfMirroredPointsIsARotation) {
    for (int i = 0; i < 100; ++i) {
        Eigen::Matrix3d any;
        any << vector(), vector(), vector();
        const Eigen::Matrix3d turn = rotation_of(any);
        EXPECT_NEAR(turn.determinant(), 1.0, 1e-12);
        EXPECT_LT((turn.transpose() * turn - Eigen::Matrix3d::Identity()).norm(), 1e-12);
        // none that is turned a little further fits better
        for (int axis = 0; axis < 3; ++axis)
            for (const double step : {-1e-3, 1e-3}) {
                const Eigen::Matrix3d other =
                    Eigen::AngleAxisd(step, Eigen::Vector3d::Unit(axis)).toRotationMatrix() * turn;
                EXPECT_LE((other.transpose() * any).trace(),
                          (turn.transpose() * any).trace() + 1e-12);
            }
    }
}

TEST_F(Alignment, AxesMakeTheMatrixAgain) {
    for (int i = 0; i < 100; ++i) {
        Eigen::Matrix3d any;
        any << vector(), vector(), vector();
        const Eigen::Matrix3d symmetric = any + any.transpose();
        const PrincipalAxes found = principal_axes(symmetric);
        EXPECT_LE(found.values[0], found.values[1]);
        EXPECT_LE(found.values[1], found.values[2]);
        EXPECT_LT(
            (found.axes * found.values.asDiagonal() * found.axes.transpose() - symmetric).norm(),
            1e-11);
        const Eigen::Matrix2d corner = symmetric.topLeftCorner<2, 2>();
        const Eigen::Vector2d two = eigenvalues_of(corner);
        EXPECT_LE(two[0], two[1]);
        EXPECT_NEAR(two.sum(), corner.trace(), 1e-12);
        EXPECT_NEAR(two.prod(), corner.determinant(), 1e-11);
    }
}

TEST_F(Alignment, Solves) {
    for (int i = 0; i < 50; ++i) {
        const Eigen::Index n = 1 + i % 9;
        const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(n + 6, n, [&] { return number(); });
        const Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(n + 6, [&] { return number(); });
        const Eigen::VectorXd x = solve_least_squares(a, b);
        EXPECT_LT((a.transpose() * (a * x - b)).norm(), 1e-10);
        EXPECT_LT((solve_symmetric(a.transpose() * a, a.transpose() * b) - x).norm(), 1e-6);
    }
}

}  // namespace
}  // namespace atrium::geometry
