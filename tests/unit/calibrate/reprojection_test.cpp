#include "tools/calibrate/adjust/reprojection.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace atrium::calibrate {
namespace {

// The derivative of `f` by each of `size` values, by central differences.
template <int rows, int size>
Eigen::Matrix<double, rows, size> differences(const auto& f) {
    constexpr double kStep = 1e-6;
    Eigen::Matrix<double, rows, size> slopes;
    for (int k = 0; k < size; ++k) slopes.col(k) = (f(k, kStep) - f(k, -kStep)) / (2.0 * kStep);
    return slopes;
}

class ReprojectionDerivatives : public testing::Test {
protected:
    double number() { return std::normal_distribution<double>()(random_); }
    Eigen::Vector3d vector() { return {number(), number(), number()}; }
    LensValues lens() {
        return {1000.0 + 50.0 * number(),
                640.0 + 10.0 * number(),
                512.0 + 10.0 * number(),
                0.1 * number(),
                0.05 * number(),
                0.002 * number(),
                0.002 * number(),
                0.02 * number()};
    }
    Eigen::Vector3d before_camera() {
        const double z = 2.0 + std::abs(number());
        return {0.4 * z * std::tanh(number()), 0.4 * z * std::tanh(number()), z};
    }
    std::mt19937 random_{3};
};

TEST_F(ReprojectionDerivatives, ByPointAndLens) {
    for (int i = 0; i < 100; ++i) {
        const LensValues values = lens();
        const Eigen::Vector3d point = before_camera();
        const auto seen = reproject(values, point);
        ASSERT_TRUE(seen);
        EXPECT_EQ(seen->px, *project_in_camera(values, point));
        const auto by_point = differences<2, 3>([&](int k, double step) {
            Eigen::Vector3d moved = point;
            moved[k] += step;
            return *project_in_camera(values, moved);
        });
        EXPECT_LT((by_point - seen->by_point).norm(), 1e-6 * by_point.norm());
        const auto by_lens = differences<2, 8>([&](int k, double step) {
            LensValues changed = values;
            changed[static_cast<std::size_t>(k)] += step;
            return *project_in_camera(changed, point);
        });
        EXPECT_LT((by_lens - seen->by_lens).norm(), 1e-6 * by_lens.norm());
    }
}

TEST_F(ReprojectionDerivatives, NothingIsSeenBehindTheCamera) {
    for (const double z : {0.0, -1.0, std::nan("")}) {
        EXPECT_FALSE(reproject(lens(), {0.1, 0.2, z}));
        EXPECT_FALSE(project_in_camera(lens(), {0.1, 0.2, z}));
    }
}

TEST_F(ReprojectionDerivatives, ByRotationVectorOfAnyLength) {
    for (const double angle : {0.0, 1e-9, 1e-5, 0.99e-3, 1.01e-3, 0.1, 1.0, 3.0, 5.0}) {
        for (int i = 0; i < 20; ++i) {
            const Eigen::Vector3d axis = vector().normalized(), point = vector();
            const TurnedPoint turned = turn_by(Eigen::Vector3d(angle * axis), point);
            const Eigen::AngleAxisd turn(angle, axis);
            EXPECT_LT((turned.point - turn * point).norm(), 1e-12) << angle;
            EXPECT_LT((turned.rotation - turn.toRotationMatrix()).norm(), 1e-12) << angle;
            const auto by_vector = differences<3, 3>([&](int k, double step) -> Eigen::Vector3d {
                Eigen::Vector3d changed = angle * axis;
                changed[k] += step;
                return Eigen::AngleAxisd(changed.norm(), changed.normalized()) * point;
            });
            EXPECT_LT((by_vector - turned.by_vector).norm(), 1e-7) << angle;
        }
    }
}

TEST_F(ReprojectionDerivatives, ByQuaternion) {
    for (int i = 0; i < 100; ++i) {
        const Eigen::Vector4d xyzw =
            Eigen::Vector4d(number(), number(), number(), number()).normalized();
        const Eigen::Vector3d point = vector();
        const QuaternionTurned turned = turn_by(xyzw, point);
        EXPECT_LT((turned.point - Eigen::Quaterniond(xyzw) * point).norm(), 1e-12);
        const auto by_xyzw = differences<3, 4>([&](int k, double step) {
            Eigen::Vector4d changed = xyzw;
            changed[k] += step;
            return turn_by(changed, point).point;
        });
        EXPECT_LT((by_xyzw - turned.by_xyzw).norm(), 1e-7);
    }
}

}  // namespace
}  // namespace atrium::calibrate
