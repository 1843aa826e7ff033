// The whole server in this process, over the real bus on the loopback interface.
#include "world_server/world_server.hpp"

#include "core/bus/bus.hpp"
#include "core/codec/mesh_codec.hpp"
#include "simulation_stage.hpp"
#include "tests/support/world/physics_meshes.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <thread>

namespace atrium::world_server {
namespace {

using Clock = std::chrono::steady_clock;

WorldServerConfig test_world() {
    WorldServerConfig config = floor_and_ball();
    config.bus.world = "world-server-test-" + std::to_string(getpid());
    config.bus.domain = 77;
    config.placements = {{"alice", {Eigen::Quaterniond::Identity(), {-1, 0, 0}}}};
    return config;
}

// A site and a viewer in one, to observe the server.
struct Guest {
    bus::Participant participant;
    bus::Writer<bus::SiteDescription> descriptions;
    bus::Writer<bus::SiteMesh> meshes;
    bus::Writer<bus::SceneCommand> commands;
    bus::Reader<bus::SitePlacement> placement_reader;
    bus::Reader<bus::SceneObject> object_reader;
    bus::Reader<bus::SceneState> state_reader;
    bus::Reader<bus::WorldStatus> status_reader;
    bus::Waiter waiter;
    std::map<std::string, bus::SitePlacement> placements;
    std::map<std::uint32_t, bus::SceneObject> objects;
    bus::SceneState state;
    bus::WorldStatus status;

    static Guest create(const bus::BusOptions& options) {
        bus::Participant p = bus::Participant::create(options).value();
        Guest guest{p,
                    bus::Writer<bus::SiteDescription>::create(p).value(),
                    bus::Writer<bus::SiteMesh>::create(p).value(),
                    bus::Writer<bus::SceneCommand>::create(p).value(),
                    bus::Reader<bus::SitePlacement>::create(p).value(),
                    bus::Reader<bus::SceneObject>::create(p).value(),
                    bus::Reader<bus::SceneState>::create(p).value(),
                    bus::Reader<bus::WorldStatus>::create(p).value(),
                    bus::Waiter::create(p).value(),
                    {},
                    {},
                    {},
                    {}};
        guest.waiter.add(guest.placement_reader);
        guest.waiter.add(guest.object_reader);
        guest.waiter.add(guest.state_reader);
        guest.waiter.add(guest.status_reader);
        return guest;
    }

    void take() {
        placement_reader.take([&](bus::SitePlacement&& m) { placements[m.site] = m; });
        object_reader.take([&](bus::SceneObject&& m) { objects[m.object] = m; },
                           [&](const bus::SceneObject& gone) { objects.erase(gone.object); });
        state_reader.take([&](bus::SceneState&& m) { state = std::move(m); });
        status_reader.take([&](bus::WorldStatus&& m) { status = std::move(m); });
    }

    // Returns true once `holds()`. Calls `meanwhile` about 30 times a second.
    bool wait_until(
        const std::function<bool()>& holds, const std::function<void()>& meanwhile = [] {}) {
        const Clock::time_point end = Clock::now() + std::chrono::seconds(20);
        Clock::time_point next = Clock::now();
        while (Clock::now() < end) {
            take();
            if (holds()) return true;
            if (Clock::now() >= next) {
                next += std::chrono::milliseconds(33);
                meanwhile();
            }
            waiter.wait(std::chrono::milliseconds(10));
        }
        return false;
    }

    double ball_x() const {
        return state.objects.size() < 2 ? 0.0 : state.objects[1].world_from_object.translation.x();
    }
};

TEST(WorldServer, ServesASiteAndAViewerFromArrivalToLeave) {
    const WorldServerConfig config = test_world();
    auto server = WorldServer::create(config);
    ASSERT_TRUE(server) << server.error().message;
    std::jthread running([&](std::stop_token stop) { EXPECT_TRUE((*server)->run(stop)); });
    auto guest = std::make_unique<Guest>(Guest::create(config.bus));

    // a late joiner receives the objects, their state, and the places of named sites
    ASSERT_TRUE(guest->wait_until([&] {
        return guest->objects.size() == 2 && guest->state.objects.size() == 2 &&
               guest->placements.contains("alice");
    }));
    EXPECT_EQ(guest->objects[2].name, "ball");
    EXPECT_EQ(guest->state.world, config.bus.world);

    // a foot that moves along pushes the ball
    bus::SiteDescription description;
    description.site = "alice";
    description.bounds_site.add({-1, -1, 0});
    description.bounds_site.add({2, 1, 2});
    ASSERT_TRUE(guest->descriptions.write(description));
    bus::SiteMesh mesh;
    mesh.site = "alice";
    const Timestamp start = Timestamp::now();
    const auto step_forward = [&] {
        const Timestamp now = Timestamp::now();
        const double seconds = std::chrono::duration<double>(now - start).count();
        const geometry::RigidTransform pose{Eigen::Quaterniond::Identity(),
                                            {0.5 + std::min(0.6, 0.8 * seconds), 0, 0.15}};
        ASSERT_TRUE(codec::MeshEncoder().encode(
            physics_test::make_box_mesh({0.1, 0.2, 0.3}, pose, 3), {}, mesh.draco));
        mesh.capture_time = now;
        ++mesh.frame_id;
        ASSERT_TRUE(guest->meshes.write(mesh));
    };
    EXPECT_TRUE(guest->wait_until([&] { return guest->ball_x() > 0.15; }, step_forward));
    EXPECT_TRUE(guest->wait_until([&] { return guest->status.num_contacts > 0; }));
    EXPECT_EQ(guest->status.num_sites, 1U);
    EXPECT_EQ(guest->status.num_rejected, 0U);
    EXPECT_GT(guest->status.capture_to_collision.num_samples, 0U);

    // commands: reset, add, and an invalid one
    bus::SceneCommand command;
    command.sender = "guest";
    mesh.draco.clear();  // the room is empty, which keeps the ball's place free
    mesh.capture_time = Timestamp::now();
    ASSERT_TRUE(guest->meshes.write(mesh));
    command.kind = bus::CommandKind::kAdd;
    command.object = guest->objects[2];
    command.object.object = 0;
    command.object.world_from_object.translation = {1, 1, 0.1};
    ASSERT_TRUE(guest->commands.write(command));
    EXPECT_TRUE(guest->wait_until([&] { return guest->objects.contains(1000); }));
    command.kind = bus::CommandKind::kRemove;
    command.target = 1000;
    ASSERT_TRUE(guest->commands.write(command));
    EXPECT_TRUE(guest->wait_until([&] { return !guest->objects.contains(1000); }));
    command.target = 1;  // the floor
    ASSERT_TRUE(guest->commands.write(command));
    EXPECT_TRUE(guest->wait_until([&] { return guest->status.num_rejected == 1; }));
    command.kind = bus::CommandKind::kReset;
    ASSERT_TRUE(guest->commands.write(command));
    EXPECT_TRUE(guest->wait_until([&] { return std::abs(guest->ball_x()) < 0.01; }));

    // the site leaves
    guest.reset();
    auto witness = std::make_unique<Guest>(Guest::create(config.bus));
    EXPECT_TRUE(witness->wait_until(
        [&] { return witness->status.num_steps > 0 && witness->status.num_sites == 0; }));
    EXPECT_EQ((*server)->status().num_sites, 0U);
}

TEST(WorldServer, LateMeshOfAnEndedSiteIsNoNewArrival) {
    const WorldServerConfig config = test_world();
    auto server = WorldServer::create(config);
    ASSERT_TRUE(server) << server.error().message;
    std::jthread running([&](std::stop_token stop) { EXPECT_TRUE((*server)->run(stop)); });
    Guest guest = Guest::create(config.bus);
    bus::SiteDescription description;
    description.site = "alice";
    description.bounds_site.add({-1, -1, 0});
    description.bounds_site.add({2, 1, 2});
    bus::SiteMesh mesh;
    mesh.site = "alice";
    ASSERT_TRUE(codec::MeshEncoder().encode(
        physics_test::make_box_mesh(
            {0.1, 0.2, 0.3}, {Eigen::Quaterniond::Identity(), {0, 0, 1}}, 3),
        {},
        mesh.draco));
    const auto send_mesh = [&] {
        mesh.capture_time = Timestamp::now();
        ++mesh.frame_id;
        ASSERT_TRUE(guest.meshes.write(mesh));
    };
    const auto is_there = [&] {
        return (*server)->status().num_sites == 1 && (*server)->status().num_meshes_received > 0;
    };
    ASSERT_TRUE(guest.descriptions.write(description));
    ASSERT_TRUE(guest.wait_until(is_there, send_mesh));

    // as if these meshes had waited in a queue while the description was disposed
    ASSERT_TRUE(guest.descriptions.dispose(description));
    ASSERT_TRUE(guest.wait_until([&] { return (*server)->status().num_sites == 0; }));
    const std::uint64_t num_before = (*server)->status().num_meshes_received;
    bool has_arrived = false;
    EXPECT_TRUE(guest.wait_until(
        [&] {
            has_arrived |= (*server)->status().num_sites > 0;
            return (*server)->status().num_meshes_received >= num_before + 3;
        },
        send_mesh));
    EXPECT_FALSE(has_arrived || (*server)->status().num_sites > 0);

    // a site that starts again appears again
    ASSERT_TRUE(guest.descriptions.write(description));
    EXPECT_TRUE(guest.wait_until(is_there, send_mesh));
    EXPECT_EQ((*server)->status().num_rejected, 0U);
}

TEST(WorldServer, ReleasesObjectsOfALostGuestAndRefusesForbiddenCommands) {
    WorldServerConfig config = test_world();
    config.rights.reset = {.everyone = false, .names = {"host"}};
    auto server = WorldServer::create(config);
    ASSERT_TRUE(server) << server.error().message;
    std::jthread running([&](std::stop_token stop) { EXPECT_TRUE((*server)->run(stop)); });
    auto witness = std::make_unique<Guest>(Guest::create(config.bus));
    auto guest = std::make_unique<Guest>(Guest::create(config.bus));
    ASSERT_TRUE(guest->wait_until([&] { return guest->state.objects.size() == 2; }));

    bus::SceneCommand command;
    command.sender = "guest";
    command.kind = bus::CommandKind::kReset;
    ASSERT_TRUE(guest->commands.write(command));
    ASSERT_TRUE(guest->wait_until([&] { return guest->status.num_refused == 1; }));
    EXPECT_EQ(guest->status.num_rejected, 1U);
    command.kind = bus::CommandKind::kSave;
    ASSERT_TRUE(guest->commands.write(command));
    ASSERT_TRUE(guest->wait_until([&] { return guest->status.num_refused == 2; }));

    command.kind = bus::CommandKind::kGrab;
    command.target = 2;
    command.goal_world = {0, 0, 1.5};
    ASSERT_TRUE(guest->commands.write(command));
    command.kind = bus::CommandKind::kMove;
    const auto ball_z = [](const Guest& who) {
        return who.state.objects.at(1).world_from_object.translation.z();
    };
    const auto keep_holding = [&] { ASSERT_TRUE(guest->commands.write(command)); };
    EXPECT_TRUE(guest->wait_until([&] { return ball_z(*guest) > 1.4; }, keep_holding));
    EXPECT_TRUE(guest->wait_until([&] { return guest->status.num_grabs == 1; }, keep_holding));
    guest.reset();
    EXPECT_TRUE(witness->wait_until([&] {
        return witness->state.objects.size() == 2 && ball_z(*witness) < 0.2;
    })) << "it fell";
    EXPECT_TRUE(witness->wait_until([&] { return witness->status.num_grabs == 0; }));
    EXPECT_GT(witness->status.num_bytes_published, 0U);
    EXPECT_EQ(witness->status.num_objects, 2U);
    EXPECT_GT(witness->status.step.num_samples, 0U);
}

TEST(WorldServer, ContinuesFromItsSavedState) {
    WorldServerConfig config = test_world();
    config.state_file =
        std::filesystem::temp_directory_path() / ("atrium-server-" + std::to_string(getpid()));
    config.rights.save = {};
    config.save_every_s = 0.2;
    std::filesystem::remove(config.state_file);
    const auto live = [&](const std::function<void(Guest&)>& visit) {
        auto server = WorldServer::create(config);
        ASSERT_TRUE(server) << server.error().message;
        {
            std::jthread running([&](std::stop_token stop) { EXPECT_TRUE((*server)->run(stop)); });
            auto guest = Guest::create(config.bus);
            ASSERT_TRUE(guest.wait_until([&] { return guest.state.objects.size() == 2; }));
            visit(guest);
        }
    };
    double x_m = 0.0;
    std::uint64_t tick = 0;
    bus::SceneCommand command;
    command.sender = "guest";
    live([&](Guest& guest) {
        command.kind = bus::CommandKind::kPush;
        command.target = 2;
        command.impulse_ns = {0.6, 0, 0};
        ASSERT_TRUE(guest.commands.write(command));
        EXPECT_TRUE(guest.wait_until([&] { return guest.ball_x() > 0.5; }));
        EXPECT_TRUE(guest.wait_until([&] { return guest.status.num_saves > 0; }))
            << "the server must save periodically";
        x_m = guest.ball_x();
        tick = guest.state.tick;
    });
    live([&](Guest& guest) {
        EXPECT_GE(guest.state.tick, tick);
        EXPECT_GE(guest.ball_x(), x_m - 0.01) << "the ball must be where it was, or have rolled on";
        // back to the saved state
        command.kind = bus::CommandKind::kSave;
        ASSERT_TRUE(guest.commands.write(command));
        EXPECT_TRUE(guest.wait_until([&] { return guest.status.num_saves > 1; }));
        command.kind = bus::CommandKind::kRestore;
        ASSERT_TRUE(guest.commands.write(command));
        const std::uint64_t before = guest.state.tick;
        EXPECT_TRUE(guest.wait_until([&] { return guest.state.tick > before + 30; }));
        EXPECT_GE(guest.ball_x(), x_m - 0.01);
    });
    // a damaged file: the world starts as described, and the server keeps the file
    std::filesystem::resize_file(config.state_file, 40);
    live([&](Guest& guest) { EXPECT_LT(std::abs(guest.ball_x()), 0.05); });
    const std::filesystem::path aside = config.state_file.string() + ".bad-1";
    EXPECT_TRUE(std::filesystem::exists(aside));
    std::filesystem::remove(aside);
    std::filesystem::remove(config.state_file);
}

TEST(WorldServer, KeepsTheFileOfAServerThatHoldsTheName) {
    WorldServerConfig config = test_world();
    config.state_file =
        std::filesystem::temp_directory_path() / ("atrium-taken-" + std::to_string(getpid()));
    auto server = WorldServer::create(config);
    ASSERT_TRUE(server) << server.error().message;
    std::ofstream(config.state_file) << "what the first one has saved";
    WorldServerConfig other = config;
    other.objects[1].rigid.size_m.setConstant(0.3);
    const auto second = WorldServer::create(other);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().kind, ErrorKind::kConfiguration);
    EXPECT_EQ(std::filesystem::file_size(config.state_file), 28U);
    EXPECT_FALSE(std::filesystem::exists(config.state_file.string() + ".bad-1"));
    std::filesystem::remove(config.state_file);
}

TEST(WorldServer, ReportsAnUnwritableStateFileAtStartAndEnd) {
    WorldServerConfig config = test_world();
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("atrium-gone-" + std::to_string(getpid()));
    config.state_file = folder / "world.state";
    const auto server = WorldServer::create(config);
    ASSERT_FALSE(server);
    EXPECT_EQ(server.error().kind, ErrorKind::kUnavailable);
    EXPECT_NE(server.error().message.find("world.state_file"), std::string::npos);
    std::filesystem::create_directory(folder);
    config.seconds = 0.1;
    config.save_every_s = 0.0;
    auto kept = WorldServer::create(config);
    ASSERT_TRUE(kept) << kept.error().message;
    EXPECT_TRUE(std::filesystem::is_empty(folder)) << "the check must leave no file";
    std::filesystem::remove(folder);
    EXPECT_FALSE((*kept)->run({}));
}

TEST(WorldServer, EndsAfterItsTimeLimit) {
    WorldServerConfig config = test_world();
    config.seconds = 0.3;
    auto server = WorldServer::create(config);
    ASSERT_TRUE(server);
    const auto begin = Clock::now();
    ASSERT_TRUE((*server)->run({}));
    const std::chrono::duration<double> ran = Clock::now() - begin;
    const auto num_steps = static_cast<double>((*server)->status().num_steps);
    EXPECT_GT(num_steps, 3.0);
    EXPECT_LE(num_steps, config.tick_hz * ran.count() + 1.0)
        << "steps must not run faster than real time";
}

TEST(WorldServer, NamesErrorsOfItsDescription) {
    WorldServerConfig config = test_world();
    config.objects[1].rigid.mass_kg = 1e9;
    const auto server = WorldServer::create(config);
    ASSERT_FALSE(server);
    EXPECT_EQ(server.error().kind, ErrorKind::kConfiguration);
}

}  // namespace
}  // namespace atrium::world_server
