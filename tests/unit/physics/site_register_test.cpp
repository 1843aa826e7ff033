#include "world_server/site_register.hpp"

#include "core/codec/mesh_codec.hpp"
#include "meshes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

namespace atrium::world_server {
namespace {

using testing::HasSubstr;

bus::SiteMesh mesh_message(const geometry::TriangleMesh& mesh, std::int64_t capture_ms) {
    bus::SiteMesh message;
    message.site = "alice";
    message.capture_time = {capture_ms * 1'000'000};
    EXPECT_TRUE(codec::encode_mesh(mesh, {}, message.draco));
    return message;
}

const NamedPlacement kAlice{
    "alice",
    {Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ())), {2, 0, 0}}};

geometry::TriangleMesh hand_at(double x) {
    return physics_test::make_box_mesh(
        {0.1, 0.1, 0.1}, {Eigen::Quaterniond::Identity(), {x, 0, 1}}, 3);
}

TEST(SiteRegister, PutsMeshesWhereTheSiteStands) {
    SiteRegister sites({kAlice}, 4, {});
    ASSERT_TRUE(sites.arrive("alice").value().has_value());
    EXPECT_FALSE(sites.arrive("alice").value().has_value()) << "it is there already";
    const auto shape = sites.read_mesh(mesh_message(hand_at(0.5), 1000));
    ASSERT_TRUE(shape && *shape);
    geometry::Aabb bounds;
    for (const auto& surfel : *(*shape)->surfels) bounds.add(surfel.position.cast<double>());
    const Eigen::Vector3d centre = bounds.centre();
    EXPECT_LT((centre - Eigen::Vector3d(1.5, 0, 1)).norm(), 0.02);
}

TEST(SiteRegister, MeasuresVelocityInTheWorld) {
    SiteRegister sites({kAlice}, 4, {});
    ASSERT_TRUE(sites.arrive("alice"));
    ASSERT_TRUE(sites.read_mesh(mesh_message(hand_at(0.50), 1000)));
    const auto shape = sites.read_mesh(mesh_message(hand_at(0.55), 1050));
    ASSERT_TRUE(shape && *shape);
    for (const auto& surfel : *(*shape)->surfels) EXPECT_NEAR(surfel.velocity.x(), -1.0, 0.1);
}

TEST(SiteRegister, RefusesBrokenLateAndFarMeshes) {
    SiteRegister sites({kAlice}, 4, {});
    ASSERT_TRUE(sites.arrive("alice"));
    ASSERT_TRUE(sites.read_mesh(mesh_message(hand_at(0), 5000)));
    EXPECT_THAT(sites.read_mesh(mesh_message(hand_at(0), 5000)).error().message,
                HasSubstr("before the last"));
    EXPECT_FALSE(sites.read_mesh(mesh_message(hand_at(0), 4900)));
    bus::SiteMesh broken = mesh_message(hand_at(0), 5100);
    broken.draco.resize(broken.draco.size() / 2);
    EXPECT_FALSE(sites.read_mesh(broken));
    EXPECT_FALSE(sites.read_mesh(mesh_message(hand_at(100.0), 5200)));
    EXPECT_TRUE(sites.read_mesh(mesh_message(hand_at(0), 5300))) << "it recovers";
    EXPECT_TRUE(sites.read_mesh(mesh_message(hand_at(0), 100))) << "a recording that starts again";
}

TEST(SiteRegister, FollowsAClockThatIsSetByHoursEitherWay) {
    constexpr std::int64_t kHours_ms = 5 * 3600 * 1000;
    SiteRegister sites({kAlice}, 4, {});
    ASSERT_TRUE(sites.arrive("alice"));
    const std::int64_t begin_ms = 2 * kHours_ms;
    for (const std::int64_t jump_ms : {std::int64_t{0}, kHours_ms, std::int64_t{0}, -kHours_ms}) {
        for (int frame = 0; frame < 3; ++frame) {
            const auto shape =
                sites.read_mesh(mesh_message(hand_at(0), begin_ms + jump_ms + 33 * (frame + 1)));
            EXPECT_TRUE(shape) << "jump " << jump_ms << " frame " << frame;
        }
    }
}

TEST(SiteRegister, TakesAnEmptyMeshForAnEmptyRoom) {
    SiteRegister sites({kAlice}, 4, {});
    ASSERT_TRUE(sites.arrive("alice"));
    const auto shape = sites.read_mesh(mesh_message({}, 1000));
    ASSERT_TRUE(shape);
    EXPECT_FALSE(shape->has_value());
}

TEST(SiteRegister, PlacesUnnamedSitesOnARingAndKeepsTheirPlaces) {
    SiteRegister sites({kAlice}, 3, {});
    const auto first = sites.arrive("x");
    const auto second = sites.arrive("y");
    ASSERT_TRUE(first && *first && second && *second);
    for (const auto& placement : {**first, **second}) {
        EXPECT_NEAR(placement.world_from_site.translation.norm(), 1.8, 1e-9);
        const Eigen::Vector3d ahead = placement.world_from_site * Eigen::Vector3d(1.8, 0, 0);
        EXPECT_LT(ahead.norm(), 1e-9) << "it faces the centre";
    }
    EXPECT_GT(
        ((*first)->world_from_site.translation - (*second)->world_from_site.translation).norm(),
        3.0);
    const auto third = sites.arrive("z");
    ASSERT_FALSE(third);
    EXPECT_EQ(third.error().kind, ErrorKind::kUnavailable);
    EXPECT_TRUE(sites.arrive("alice")) << "named sites always have room";

    sites.leave("x");
    EXPECT_EQ(sites.num_present(), 2U);
    const auto again = sites.arrive("x");
    ASSERT_TRUE(again && *again);
    EXPECT_EQ((*again)->world_from_site.translation, (*first)->world_from_site.translation);
}

}  // namespace
}  // namespace atrium::world_server
