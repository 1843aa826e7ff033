#include "core/geometry/rigid_transform.hpp"

#include "core/geometry/roll_pitch_yaw.hpp"

#include <gtest/gtest.h>

#include <random>

namespace atrium::geometry {
namespace {

RigidTransform random_transform(std::mt19937& random) {
    std::normal_distribution<double> normal;
    const Eigen::Vector4d q(normal(random), normal(random), normal(random), normal(random));
    return {Eigen::Quaterniond(q.normalized()), {normal(random), normal(random), normal(random)}};
}

TEST(RigidTransform, ProductAndInverseObeyTheGroupLaws) {
    std::mt19937 random(7);
    for (int i = 0; i < 200; ++i) {
        const RigidTransform a_from_b = random_transform(random);
        const RigidTransform b_from_c = random_transform(random);
        const Eigen::Vector3d p_c = random_transform(random).translation;
        const RigidTransform a_from_c = a_from_b * b_from_c;
        EXPECT_LT((a_from_c * p_c - a_from_b * (b_from_c * p_c)).norm(), 1e-12);
        EXPECT_LT((a_from_b.inverse() * (a_from_b * p_c) - p_c).norm(), 1e-12);
        EXPECT_LT((a_from_c.matrix() - a_from_b.matrix() * b_from_c.matrix()).norm(), 1e-12);
    }
}

TEST(RollPitchYaw, TurnsAboutXThenYThenZOfTheWorld) {
    const Eigen::Quaterniond turned = rotation_of_roll_pitch_yaw({90.0, 0.0, 90.0});
    // about x the z axis becomes -y, which about z becomes +x
    EXPECT_LT((turned * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitX()).norm(), 1e-12);
    EXPECT_LT((turned * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-12);
}

TEST(RollPitchYaw, AnglesGiveTheRotationBack) {
    std::mt19937 random(7);
    for (int i = 0; i < 1000; ++i) {
        Eigen::Quaterniond rotation = random_transform(random).rotation;
        if (i % 10 == 0) rotation = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY());
        const Eigen::Vector3d angles_deg = roll_pitch_yaw_deg(rotation);
        EXPECT_LE(std::abs(angles_deg.y()), 90.0);
        EXPECT_LT(rotation_of_roll_pitch_yaw(angles_deg).angularDistance(rotation), 1e-7);
    }
}

}  // namespace
}  // namespace atrium::geometry
