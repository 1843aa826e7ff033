#include "world_server/proxies.hpp"

#include "core/bus/checks.hpp"
#include "core/bus/limits.hpp"
#include "core/bus/proxy_points.hpp"
#include "simulation_stage.hpp"
#include "tests/support/world/physics_meshes.hpp"
#include "world_server/scene_messages.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

namespace atrium::world_server {
namespace {

physics::PersonSnapshot person_of(std::size_t num_surfels) {
    std::vector<physics::MovingSurfel> surfels;
    for (std::size_t i = 0; i < num_surfels; ++i) {
        const float x_m = 1e-3F * static_cast<float>(i);
        surfels.push_back({{x_m, 2, 1}, {0, 0.6F, 0.8F}, {x_m - 0.2F, 2, 1}, {2, -0.5F, 40}});
    }
    physics::PersonSnapshot person;
    person.name = "alice";
    person.surfels = std::make_shared<const std::vector<physics::MovingSurfel>>(surfels);
    person.share_to_go = 0.25F;
    person.capture_time = {77};
    return person;
}

TEST(PersonProxy, HasSurfelsAtTheirCurrentPlaceWithVelocities) {
    std::vector<Eigen::Vector3f> places;
    bus::PersonProxy proxy;
    fill_proxy(person_of(100), places, proxy);
    ASSERT_TRUE(bus::check(proxy));
    EXPECT_EQ(proxy.site, "alice");
    EXPECT_EQ(proxy.capture_time, Timestamp{77});
    EXPECT_EQ(proxy.num_surfels, 100U);
    ASSERT_EQ(proxy.points.size(), 100U);
    for (std::size_t i = 0; i < 100; ++i) {
        // a quarter of the 20 cm is still to go
        const Eigen::Vector3d expected(1e-3 * static_cast<double>(i) - 0.05, 2, 1);
        EXPECT_LT((bus::place_of(proxy, i) - expected).norm(), 1e-5);
        const Eigen::Vector3d velocity = bus::velocity_of(proxy.points[i]);
        EXPECT_LT((velocity - Eigen::Vector3d(2, -0.5, 32.767)).norm(), 1e-6) << "at most";
        const Eigen::Vector3d normal = bus::normal_of(proxy.points[i]);
        EXPECT_LT((normal - Eigen::Vector3d(0, 0.6, 0.8)).norm(), 1e-4);
    }
}

TEST(PersonProxy, SamplesManySurfelsEvenly) {
    std::vector<Eigen::Vector3f> places;
    bus::PersonProxy proxy;
    fill_proxy(person_of(bus::kMaxProxyPoints), places, proxy);
    EXPECT_EQ(proxy.points.size(), bus::kMaxProxyPoints)
        << "a full proxy must keep all of its points";
    fill_proxy(person_of(5000), places, proxy);
    ASSERT_TRUE(bus::check(proxy));
    EXPECT_EQ(proxy.num_surfels, 5000U);
    ASSERT_EQ(proxy.points.size(), 1667U) << "every third surfel";
    for (std::size_t i = 1; i < proxy.points.size(); ++i)
        EXPECT_NEAR(bus::place_of(proxy, i).x() - bus::place_of(proxy, i - 1).x(), 3e-3, 2e-4);
}

TEST(PersonProxy, ListsTouchesUpToALimit) {
    physics::PersonSnapshot person = person_of(1);
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
    EXPECT_TRUE(proxy.touches.empty()) << "touches of the previous call must be gone";
}

physics::PersonShape hand_at(double x_m) {
    physics::PersonShaper shaper{physics::PersonShapeOptions{}};
    return shaper.shape(physics_test::make_box_mesh(
                            {0.1, 0.2, 0.2}, {Eigen::Quaterniond::Identity(), {x_m, 0, 0.12}}, 10),
                        Timestamp{5});
}

TEST(WorldPeople, HaveTheSurfaceAndTouchesOfThePhysics) {
    Scene scene = Scene::create(floor_and_ball()).value();
    physics::World& world = scene.world();
    std::vector<physics::PersonSnapshot> people;
    world.get_people(people);
    EXPECT_TRUE(people.empty());
    world.set_person("bob", hand_at(3.0));
    world.set_person("alice", hand_at(-0.14));  // 1 cm into the ball
    world.tick();
    world.get_people(people);
    ASSERT_EQ(people.size(), 2U);
    EXPECT_EQ(people[0].name, "alice");
    EXPECT_EQ(people[0].capture_time, Timestamp{5});
    EXPECT_EQ(people[0].surfels->size(), world.num_surfels() - people[1].surfels->size());
    ASSERT_FALSE(people[0].touches.empty());
    for (const auto& touch : people[0].touches) {
        EXPECT_EQ(touch.object, 2U);
        EXPECT_NEAR(touch.point.x(), -0.09F, 0.01F) << "the touch must be on the hand's side";
        EXPECT_LT((touch.point - Eigen::Vector3f(0, 0, 0.1F)).norm(), 0.12F);
    }
    EXPECT_TRUE(people[1].touches.empty());
    world.set_person("alice", hand_at(-1.0));
    world.tick();
    world.get_people(people);
    EXPECT_TRUE(people[0].touches.empty()) << "touches of the previous tick must be gone";
}

TEST(Simulation, SendsPeopleTenTimesASecondOnRequestOnly) {
    auto simulation = simulation_of(floor_and_ball(), [](const std::string&) {});
    simulation.people().put("alice", hand_at(1.0));
    Outbox::Content content;
    std::int64_t tick = 0;
    const auto num_told_in_a_second = [&] {
        int num = 0;
        for (int i = 0; i < 120; ++i) {
            simulation.step(Timestamp{++tick * 8'333'333});
            simulation.outbox().take(content, {}, std::chrono::steady_clock::now());
            num += content.has_people ? 1 : 0;
        }
        return num;
    };
    EXPECT_EQ(num_told_in_a_second(), 0);
    simulation.want_people(true);
    EXPECT_EQ(num_told_in_a_second(), 10);
    ASSERT_EQ(content.people.size(), 1U);
    EXPECT_EQ(content.people.front().name, "alice");
    simulation.want_people(false);
    EXPECT_EQ(num_told_in_a_second(), 0);
}

TEST(ObjectProxy, ExistsForAModelNotForItsReplacement) {
    WorldServerConfig config = floor_and_ball();
    WorldObject rock;
    rock.rigid.id = 3;
    rock.name = "rock";
    rock.rigid.shape = physics::ObjectShape::kConvex;
    rock.look.model = "rock.obj";
    rock.rigid.mass_kg = 10.0;
    rock.rigid.size_m = {0.2, 0.4, 0.6};
    rock.rigid.world_from_object.translation = {2, 0, 0.3};
    rock.rigid.parts = std::make_shared<const std::vector<geometry::TriangleMesh>>(
        1, physics_test::make_box_mesh(rock.rigid.size_m, {}, 1));
    config.objects.push_back(rock);
    Scene scene = Scene::create(config).value();
    for (const SceneChange& change : scene.all())
        EXPECT_EQ(change.proxy.has_value(), change.object.object == 3) << change.object.object;
    bus::SceneCommand command;
    command.kind = bus::CommandKind::kRemove;
    command.target = 3;
    ASSERT_TRUE(scene.apply(command));
    command.kind = bus::CommandKind::kAdd;
    command.object = to_message(config.objects[1]);
    command.object.object = 3;
    command.object.world_from_object.translation = {2, 0, 0.3};
    ASSERT_TRUE(scene.apply(command));
    for (const SceneChange& change : scene.all()) EXPECT_FALSE(change.proxy);
}

TEST(ObjectProxy, HasTheEdgesOfEachPartWithoutFaceDiagonals) {
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
    EXPECT_EQ(proxy.edges.size(), 24U) << "twelve edges per part, without face diagonals";
    for (const auto& [from, to] : proxy.edges) {
        const Eigen::Vector3d a = bus::vertex_of(proxy, from);
        const Eigen::Vector3d way = bus::vertex_of(proxy, to) - a;
        EXPECT_NEAR(way.cwiseAbs().maxCoeff(), way.norm(), 1e-5) << "an edge must follow an axis";
        EXPECT_NEAR(std::abs(std::abs(a.x()) - 0.5), 0.1, 1e-5);
        EXPECT_NEAR(std::abs(a.z()), 0.3, 1e-5);
    }
}

TEST(ObjectProxy, OmitsPartsBeyondItsLimit) {
    const geometry::TriangleMesh part = physics_test::make_sphere_mesh(0.1, {0, 0, 0}, 20);
    const std::vector<geometry::TriangleMesh> parts(64, part);
    const bus::ObjectProxy proxy = make_object_proxy(7, parts);
    ASSERT_TRUE(bus::check(proxy)) << bus::check(proxy).error().message;
    ASSERT_GT(part.vertices.size() * parts.size(), bus::kMaxProxyVertices);
    EXPECT_GE(proxy.vertices.size(), part.vertices.size());
    EXPECT_EQ(proxy.vertices.size() % part.vertices.size(), 0U) << "only whole parts may be sent";
}

}  // namespace
}  // namespace atrium::world_server
