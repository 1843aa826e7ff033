#include "site_node/refine/membrane.hpp"

#include "tests/support/shapes/closed_meshes.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace atrium::refine {
namespace {

// A sphere of radius 1, and which of its vertices belong to the cap above z = 0.4.
struct Cap {
    geometry::TriangleMesh mesh = test::make_sphere(4, 1.0);
    std::vector<Eigen::Vector3f> places;
    std::vector<float> shares;

    explicit Cap(float share) {
        for (const Eigen::Vector3d& vertex : mesh.vertices) {
            places.push_back(vertex.cast<float>());
            shares.push_back(vertex.z() > 0.4 ? share : 0.0F);
        }
    }
};

TEST(Membrane, IsFlatAcrossTheBaseOfACap) {
    Cap cap(1.0F);
    const std::vector<Eigen::Vector3f> before = cap.places;
    Membrane().shrink(cap.mesh.triangles, cap.shares, cap.places);
    for (std::size_t v = 0; v < before.size(); ++v) {
        if (cap.shares[v] > 0.0F) {
            EXPECT_NEAR(cap.places[v].z(), 0.36F, 0.08F);
            EXPECT_LT(cap.places[v].head<2>().norm(), 0.95F);
        } else {
            EXPECT_EQ(cap.places[v], before[v]);
        }
    }
}

TEST(Membrane, GoesAsFarAsTheShareSays) {
    Cap whole(1.0F);
    Cap quarter(0.25F);
    const std::vector<Eigen::Vector3f> before = whole.places;
    Membrane membrane;
    membrane.shrink(whole.mesh.triangles, whole.shares, whole.places);
    membrane.shrink(quarter.mesh.triangles, quarter.shares, quarter.places);
    for (std::size_t v = 0; v < before.size(); ++v) {
        const Eigen::Vector3f expected = before[v] + 0.25F * (whole.places[v] - before[v]);
        EXPECT_LT((quarter.places[v] - expected).norm(), 1e-6F);
    }
}

TEST(Membrane, LeavesWhatIsReal) {
    Cap cap(0.0F);
    const std::vector<Eigen::Vector3f> before = cap.places;
    Membrane().shrink(cap.mesh.triangles, cap.shares, cap.places);
    EXPECT_EQ(cap.places, before);
}

}  // namespace
}  // namespace atrium::refine
