#include "core/bus/bus.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/world/foot_recording.hpp"
#include "world_server/world_server.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <thread>

// The program `play` plays one person of a recording, under another name, into a world with a
// living world server: she is as physical as living people, at the place that the server gives her.
namespace atrium {
namespace {

using Clock = std::chrono::steady_clock;
using physics_test::FootRecording;

constexpr std::uint32_t kDomain = 186;  // used by this test only
constexpr double kLengthS = 3.0;
constexpr double kRecordedX = 50.0;  // of alice's place in the recorded world
constexpr double kPlaceX = -1.0;     // of anna's in the living one
const auto kPatience = std::chrono::seconds(60);

bus::BusOptions bus_options() {
    bus::BusOptions options;
    options.world = "played-person-test-" + std::to_string(::getpid());
    options.domain = kDomain;
    return options;
}

world_server::WorldServerConfig world_config() {
    world_server::WorldServerConfig config;
    config.bus = bus_options();
    world_server::WorldObject floor;
    floor.rigid.id = 1;
    floor.name = "floor";
    floor.rigid.shape = physics::ObjectShape::kPlane;
    world_server::WorldObject ball;
    ball.rigid.id = 2;
    ball.name = "ball";
    ball.rigid.shape = physics::ObjectShape::kSphere;
    ball.rigid.size_m.setConstant(0.2);
    ball.rigid.mass_kg = 0.5;
    ball.rigid.world_from_object.translation = {0, 0, 0.1};
    config.objects = {floor, ball};
    config.placements = {{"anna", {Eigen::Quaterniond::Identity(), {kPlaceX, 0, 0}}}};
    return config;
}

// Alice's foot comes from 0.5 m in front of the ball and pushes it.
std::filesystem::path write_recording() {
    FootRecording recording(std::filesystem::path(testing::TempDir()) /
                            ("played-person-" + std::to_string(::getpid()) + ".mcap"));
    bus::Presence alice;
    alice.kind = bus::ProgramKind::kSiteNode;
    alice.name = "alice";
    recording.write(0.0, alice);
    recording.describe(0.0, "alice");
    recording.describe(0.0, "bob");
    recording.write(
        0.0, bus::SitePlacement{"alice", {Eigen::Quaterniond::Identity(), {kRecordedX, 0, 0}}});
    bus::StreamFeedback feedback;
    feedback.viewer = "recorded";
    feedback.site = "alice";
    recording.write(0.5, feedback);
    for (int i = 0; i <= static_cast<int>(kLengthS * 30.0); ++i) {
        const double time_s = i / 30.0;
        recording.put_foot(time_s, "alice", {0.5 + 0.8 * time_s / kLengthS, 0, 0.15});
        recording.put_foot(time_s, "bob", {0, 1, 0.15});
    }
    recording.finish();
    return recording.file();
}

TEST(PlayedPerson, PushesABallBesideTheLiving) {
    auto server = world_server::WorldServer::create(world_config());
    ASSERT_TRUE(server) << server.error().message;
    std::jthread serving([&](std::stop_token stop) { EXPECT_TRUE((*server)->run(stop)); });

    const bus::Participant participant = bus::Participant::create(bus_options()).value();
    auto states = bus::Reader<bus::SceneState>::create(participant).value();
    auto placements = bus::Reader<bus::SitePlacement>::create(participant).value();
    auto descriptions = bus::Reader<bus::SiteDescription>::create(participant).value();
    auto feedback = bus::Reader<bus::StreamFeedback>::create(participant).value();
    auto waiter = bus::Waiter::create(participant).value();
    waiter.add(states);
    waiter.add(placements);
    waiter.add(descriptions);
    double ball_x = 0.0;
    std::vector<bus::SitePlacement> places;
    std::vector<std::string> sites;
    std::uint64_t num_feedback = 0;
    const auto wait_until = [&](const std::function<bool()>& holds) {
        const Clock::time_point end = Clock::now() + kPatience;
        while (!holds() && Clock::now() < end) {
            waiter.wait(std::chrono::milliseconds(100));
            states.take([&](bus::SceneState&& state) {
                for (const bus::ObjectState& object : state.objects)
                    if (object.object == 2) ball_x = object.world_from_object.translation.x();
            });
            placements.take([&](bus::SitePlacement&& place) { places.push_back(place); });
            descriptions.take(
                [&](bus::SiteDescription&& described) { sites.push_back(described.site); });
            feedback.take([&](bus::StreamFeedback&&) { ++num_feedback; });
        }
        return holds();
    };
    // the program then finds the server, as a user's does
    ASSERT_TRUE(wait_until([&] { return !places.empty(); }));

    const std::string command = std::string(ATRIUM_BIN_DIR) + "/play " +
                                write_recording().string() +
                                " --sites alice --rename alice=anna --bus.domain " +
                                std::to_string(kDomain) + " --world " + bus_options().world;
    test_support::Outcome outcome;
    std::jthread playing([&] { outcome = test_support::run_program(command, 100); });
    EXPECT_TRUE(wait_until([&] { return ball_x > 0.1; })) << "the ball is at " << ball_x;
    const bus::WorldStatus status = (*server)->status();
    EXPECT_EQ(status.num_sites, 1U);
    EXPECT_GT(status.num_contacts, 0U);
    EXPECT_EQ(status.num_rejected, 0U);
    // from when she was played: she was captured years ago
    EXPECT_GT(status.capture_to_collision.num_samples, 0U);
    EXPECT_LT(status.capture_to_collision.p99_ms, 1e6);
    playing.join();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_TRUE(wait_until([&] { return (*server)->status().num_sites == 0; }));

    EXPECT_TRUE(std::ranges::all_of(sites, [](const auto& site) { return site == "anna"; }));
    EXPECT_FALSE(sites.empty());
    for (const bus::SitePlacement& place : places) {
        EXPECT_EQ(place.site, "anna");
        EXPECT_EQ(place.world_from_site.translation.x(), kPlaceX);
    }
    EXPECT_EQ(num_feedback, 0U);  // of a viewer that is not there
}

}  // namespace
}  // namespace atrium
