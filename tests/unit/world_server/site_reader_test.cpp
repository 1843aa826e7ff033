#include "world_server/site_reader.hpp"

#include "core/codec/mesh_codec.hpp"
#include "tests/support/world/physics_meshes.hpp"

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
    EXPECT_TRUE(codec::MeshEncoder().encode(mesh, {}, message.draco));
    return message;
}

const geometry::RigidTransform kWorldFromAlice{
    Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ())), {2, 0, 0}};

geometry::TriangleMesh hand_mesh_at(double x) {
    return physics_test::make_box_mesh(
        {0.1, 0.1, 0.1}, {Eigen::Quaterniond::Identity(), {x, 0, 1}}, 3);
}

TEST(SiteReader, TransformsMeshesByThePlaceOfTheSite) {
    SiteReader reader(kWorldFromAlice, {});
    const auto shape = reader.read(mesh_message(hand_mesh_at(0.5), 1000));
    ASSERT_TRUE(shape && *shape);
    geometry::Aabb bounds;
    for (const auto& surfel : *(*shape)->surfels) bounds.add(surfel.position.cast<double>());
    const Eigen::Vector3d centre = bounds.centre();
    EXPECT_LT((centre - Eigen::Vector3d(1.5, 0, 1)).norm(), 0.02);
}

TEST(SiteReader, MeasuresVelocityInTheWorld) {
    SiteReader reader(kWorldFromAlice, {});
    ASSERT_TRUE(reader.read(mesh_message(hand_mesh_at(0.50), 1000)));
    const auto shape = reader.read(mesh_message(hand_mesh_at(0.55), 1050));
    ASSERT_TRUE(shape && *shape);
    for (const auto& surfel : *(*shape)->surfels) EXPECT_NEAR(surfel.velocity.x(), -1.0, 0.1);
}

TEST(SiteReader, RefusesBrokenLateAndFarMeshes) {
    SiteReader reader(kWorldFromAlice, {});
    ASSERT_TRUE(reader.read(mesh_message(hand_mesh_at(0), 5000)));
    EXPECT_THAT(reader.read(mesh_message(hand_mesh_at(0), 5000)).error().message,
                HasSubstr("before the last"));
    EXPECT_FALSE(reader.read(mesh_message(hand_mesh_at(0), 4900)));
    bus::SiteMesh broken = mesh_message(hand_mesh_at(0), 5100);
    broken.draco.resize(broken.draco.size() / 2);
    EXPECT_FALSE(reader.read(broken));
    EXPECT_FALSE(reader.read(mesh_message(hand_mesh_at(100.0), 5200)));
    EXPECT_TRUE(reader.read(mesh_message(hand_mesh_at(0), 5300))) << "it recovers";
    EXPECT_TRUE(reader.read(mesh_message(hand_mesh_at(0), 100)))
        << "a recording that restarts must be accepted";
}

TEST(SiteReader, FollowsAClockSetByHoursInEitherDirection) {
    constexpr std::int64_t kHours_ms = 5 * 3600 * 1000;
    SiteReader reader(kWorldFromAlice, {});
    const std::int64_t begin_ms = 2 * kHours_ms;
    for (const std::int64_t jump_ms : {std::int64_t{0}, kHours_ms, std::int64_t{0}, -kHours_ms}) {
        for (int frame = 0; frame < 3; ++frame) {
            const auto shape =
                reader.read(mesh_message(hand_mesh_at(0), begin_ms + jump_ms + 33 * (frame + 1)));
            EXPECT_TRUE(shape) << "jump " << jump_ms << " frame " << frame;
        }
    }
}

TEST(SiteReader, TreatsAnEmptyMeshAsAnEmptyRoom) {
    SiteReader reader(kWorldFromAlice, {});
    const auto shape = reader.read(mesh_message({}, 1000));
    ASSERT_TRUE(shape);
    EXPECT_FALSE(shape->has_value());
}

}  // namespace
}  // namespace atrium::world_server
