#include "world_server/proxies.hpp"

#include "core/bus/checks.hpp"
#include "core/bus/limits.hpp"
#include "core/bus/proxy_points.hpp"
#include "meshes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace atrium::world_server {
namespace {

physics::PersonNow person_of(std::size_t num_surfels) {
    std::vector<physics::MovingSurfel> surfels;
    for (std::size_t i = 0; i < num_surfels; ++i) {
        const float x_m = 1e-3F * static_cast<float>(i);
        surfels.push_back({{x_m, 2, 1}, {0, 0.6F, 0.8F}, {x_m - 0.2F, 2, 1}, {2, -0.5F, 40}});
    }
    physics::PersonNow person;
    person.name = "alice";
    person.surfels = std::make_shared<const std::vector<physics::MovingSurfel>>(surfels);
    person.share_to_go = 0.25F;
    person.capture_time = {77};
    return person;
}

TEST(PersonProxy, HasSurfelsWhereTheyAreNowAndHowTheyMove) {
    std::vector<Eigen::Vector3f> places;
    bus::PersonProxy proxy;
    fill_proxy(person_of(100), places, proxy);
    ASSERT_TRUE(bus::check(proxy));
    EXPECT_EQ(proxy.site, "alice");
    EXPECT_EQ(proxy.capture_time, Timestamp{77});
    EXPECT_EQ(proxy.num_surfels, 100U);
    ASSERT_EQ(proxy.points.size(), 100U);
    for (std::size_t i = 0; i < 100; ++i) {
        // a quarter of the way of 20 cm is still to go
        const Eigen::Vector3d expected(1e-3 * static_cast<double>(i) - 0.05, 2, 1);
        EXPECT_LT((bus::place_of(proxy, i) - expected).norm(), 1e-5);
        const Eigen::Vector3d velocity = bus::velocity_of(proxy.points[i]);
        EXPECT_LT((velocity - Eigen::Vector3d(2, -0.5, 32.767)).norm(), 1e-6) << "at most";
        const Eigen::Vector3d normal = bus::normal_of(proxy.points[i]);
        EXPECT_LT((normal - Eigen::Vector3d(0, 0.6, 0.8)).norm(), 1e-4);
    }
}

TEST(PersonProxy, IsAnEvenChoiceOfManySurfels) {
    std::vector<Eigen::Vector3f> places;
    bus::PersonProxy proxy;
    fill_proxy(person_of(bus::kMaxProxyPoints), places, proxy);
    EXPECT_EQ(proxy.points.size(), bus::kMaxProxyPoints) << "as many as fit are all sent";
    fill_proxy(person_of(5000), places, proxy);
    ASSERT_TRUE(bus::check(proxy));
    EXPECT_EQ(proxy.num_surfels, 5000U);
    ASSERT_EQ(proxy.points.size(), 1667U) << "every third";
    for (std::size_t i = 1; i < proxy.points.size(); ++i)
        EXPECT_NEAR(bus::place_of(proxy, i).x() - bus::place_of(proxy, i - 1).x(), 3e-3, 2e-4);
}

TEST(PersonProxy, SaysWhatIsTouchedUpToALimit) {
    physics::PersonNow person = person_of(1);
    for (std::uint32_t i = 0; i < 300; ++i) person.touches.push_back({i, {0.5F, 1, 2}});
    std::vector<Eigen::Vector3f> places;
    bus::PersonProxy proxy;
    fill_proxy(person, places, proxy);
    ASSERT_TRUE(bus::check(proxy));
    ASSERT_EQ(proxy.touches.size(), bus::kMaxTouches);
    EXPECT_EQ(proxy.touches[9].object, 9U);
    EXPECT_EQ(proxy.touches[9].point_world, Eigen::Vector3d(0.5, 1, 2));
    person.touches.clear();
    fill_proxy(person, places, proxy);
    EXPECT_TRUE(proxy.touches.empty()) << "not those of the time before";
}

TEST(ObjectProxy, HasTheEdgesOfEachPartWithoutThoseWithinItsFaces) {
    const Eigen::Vector3d size_m(0.2, 0.4, 0.6);
    const geometry::RigidTransform left{Eigen::Quaterniond::Identity(), {-0.5, 0, 0}};
    const geometry::RigidTransform right{Eigen::Quaterniond::Identity(), {0.5, 0, 0}};
    const bus::ObjectProxy proxy =
        make_object_proxy(7,
                          {physics_test::make_box_mesh(size_m, left, 1),
                           physics_test::make_box_mesh(size_m, right, 1)});
    ASSERT_TRUE(bus::check(proxy)) << bus::check(proxy).error().message;
    EXPECT_EQ(proxy.object, 7U);
    ASSERT_EQ(proxy.vertices.size(), 16U);
    EXPECT_EQ(proxy.edges.size(), 24U) << "twelve each, and no diagonals of faces";
    for (const auto& [from, to] : proxy.edges) {
        const Eigen::Vector3d a = bus::vertex_of(proxy, from);
        const Eigen::Vector3d way = bus::vertex_of(proxy, to) - a;
        EXPECT_NEAR(way.cwiseAbs().maxCoeff(), way.norm(), 1e-5) << "along an axis";
        EXPECT_NEAR(std::abs(std::abs(a.x()) - 0.5), 0.1, 1e-5);
        EXPECT_NEAR(std::abs(a.z()), 0.3, 1e-5);
    }
}

TEST(ObjectProxy, LeavesOutPartsBeyondItsLimit) {
    const geometry::TriangleMesh part = physics_test::make_sphere_mesh(0.1, {0, 0, 0}, 20);
    const std::vector<geometry::TriangleMesh> parts(64, part);
    const bus::ObjectProxy proxy = make_object_proxy(7, parts);
    ASSERT_TRUE(bus::check(proxy)) << bus::check(proxy).error().message;
    ASSERT_GT(part.vertices.size() * parts.size(), bus::kMaxProxyVertices);
    EXPECT_GE(proxy.vertices.size(), part.vertices.size());
    EXPECT_EQ(proxy.vertices.size() % part.vertices.size(), 0U) << "whole parts";
}

}  // namespace
}  // namespace atrium::world_server
