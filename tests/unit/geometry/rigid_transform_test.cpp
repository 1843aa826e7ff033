#include "core/geometry/rigid_transform.hpp"

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

}  // namespace
}  // namespace atrium::geometry
