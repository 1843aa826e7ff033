#include "world_server/recorded_run.hpp"

#include "core/recording/cursor.hpp"
#include "simulation_stage.hpp"
#include "tests/support/world/foot_recording.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <vector>

namespace atrium::world_server {
namespace {

namespace fs = std::filesystem;

using physics_test::FootRecording;
using physics_test::kRecordingBegin;

constexpr double kLengthS = 3.0;

fs::path file_named(const std::string& name) {
    return fs::path(testing::TempDir()) / (name + "-" + std::to_string(::getpid()) + ".mcap");
}

// Alice's foot comes from the left and pushes the ball; bob's comes later, from the right.
fs::path push_recording(const std::string& name, double speed_mps = 0.8) {
    FootRecording recording(file_named(name));
    recording.describe(0.0, "alice");
    recording.describe(0.001, "bob");
    const auto num = static_cast<int>(kLengthS * 30.0);
    for (int i = 0; i <= num; ++i) {
        const double time_s = i / 30.0;
        const double way_m = std::min(0.6, speed_mps * time_s);
        recording.put_foot(time_s + 0.002, "alice", {-0.5 + way_m, 0, 0.15});
        recording.put_foot(time_s + 0.003, "bob", {-0.8 - std::min(0.6, 0.4 * time_s), 0.05, 0.15});
    }
    recording.finish();
    return recording.file();
}

WorldServerConfig config_of(const fs::path& file) {
    WorldServerConfig config = floor_and_ball();
    config.recording.file = file;
    config.placements = {{"alice", {}}, {"bob", {Eigen::Quaterniond::Identity(), {2, 0, 0}}}};
    return config;
}

struct Result {
    std::vector<std::uint64_t> hashes;  // after each second, and of the end
    RecordedState last;
    RecordedCounts counts;
};

Result run(const WorldServerConfig& config) {
    auto created = RecordedRun::create(config);
    EXPECT_TRUE(created) << created.error().message;
    if (!created) return {};
    Result result;
    const auto last = (*created)->run(
        {}, [&](const RecordedState& state) { result.hashes.push_back(state.hash); });
    EXPECT_TRUE(last) << last.error().message;
    if (!last) return {};
    result.last = *last;
    result.hashes.push_back(last->hash);
    result.counts = (*created)->counts();
    return result;
}

// The samples of one topic in a file.
template <typename Message>
std::vector<std::pair<Timestamp, Message>> samples_of(const fs::path& file) {
    std::vector<std::pair<Timestamp, Message>> samples;
    auto world = recording::WorldFile::open(file);
    EXPECT_TRUE(world) << world.error().message;
    if (!world) return samples;
    EXPECT_EQ((*world)->file().fault(), "");
    recording::Cursor cursor(*world);
    for (const auto* sample = cursor.peek(); sample != nullptr;
         cursor.pop(), sample = cursor.peek()) {
        if (sample->topic->name() != bus::topic_name<Message>() ||
            sample->raw.kind != bus::RawKind::kSample)
            continue;
        auto message = bus::from_raw<Message>(sample->raw);
        EXPECT_TRUE(message) << message.error().message;
        if (message) samples.emplace_back(sample->time, std::move(*message));
    }
    return samples;
}

double last_ball_x(const fs::path& file) {
    const auto states = samples_of<bus::SceneState>(file);
    EXPECT_FALSE(states.empty());
    double x = 0.0;
    for (const auto& object :
         states.empty() ? std::vector<bus::ObjectState>{} : states.back().second.objects) {
        if (object.object == 2) x = object.world_from_object.translation.x();
    }
    return x;
}

TEST(RecordedRun, GivesTheSameStatesWithAnyNumberOfThreads) {
    WorldServerConfig config = config_of(push_recording("same"));
    config.recording.threads = 1;
    const Result one = run(config);
    ASSERT_EQ(one.hashes.size(), 4U);
    EXPECT_EQ(one.last.tick, 361U);  // the last mesh is 3 ms behind the third second
    EXPECT_EQ(one.counts.num_meshes, 182U);
    EXPECT_EQ(one.counts.num_rejected, 0U);
    for (const int threads : {1, 2, 4}) {
        config.recording.threads = threads;
        EXPECT_EQ(run(config).hashes, one.hashes) << threads << " threads";
    }
    // the people do count
    const Result other = run(config_of(push_recording("other", 0.7)));
    ASSERT_EQ(other.hashes.size(), 4U);
    EXPECT_NE(other.last.hash, one.last.hash);
}

TEST(RecordedRun, TicksLikeALiveWorldWithoutPeople) {
    FootRecording recording(file_named("nobody"));
    recording.describe(0.0, "alice");
    recording.put_foot(0.001, "alice", {0, 1.5, 0.15});  // far from the ball
    recording.describe(kLengthS, "alice");
    recording.finish();
    WorldServerConfig config = config_of(recording.file());
    config.objects[1].rigid.world_from_object.translation.z() = 1.0;  // it falls
    const Result result = run(config);
    Simulation live = simulation_of(config, [](const std::string&) {});
    std::vector<std::uint64_t> hashes;
    for (int tick = 1; tick <= 360; ++tick) {
        live.step(Timestamp::now());
        if (tick % 120 == 0) hashes.push_back(live.state_hash());
    }
    hashes.push_back(live.state_hash());
    EXPECT_EQ(result.hashes, hashes);
}

TEST(RecordedRun, WritesTheRecordedPeopleWithTheObjectsOfThisWorld) {
    FootRecording recording(file_named("source"));
    bus::SceneObject foreign;  // of the recorded world
    foreign.object = 7;
    foreign.name = "foreign";
    recording.write(0.0, foreign);
    bus::SceneState state;
    state.world = "rec";
    bus::ObjectState at_rest;
    at_rest.object = 7;
    at_rest.linear_velocity.setZero();
    at_rest.angular_velocity.setZero();
    state.objects.push_back(at_rest);
    recording.describe(0.0, "alice");
    for (int i = 0; i <= 60; ++i) {
        recording.put_foot(i / 30.0, "alice", {-0.5 + std::min(0.6, 0.8 * i / 30.0), 0, 0.15});
        recording.write(i / 30.0, state);
    }
    recording.finish();
    WorldServerConfig config = config_of(recording.file());
    config.recording.output = file_named("again");
    fs::remove(config.recording.output);
    const Result result = run(config);
    EXPECT_GT(result.counts.num_contact_ticks, 0U);

    const fs::path& again = config.recording.output;
    const auto meshes = samples_of<bus::SiteMesh>(recording.file());
    const auto same = samples_of<bus::SiteMesh>(again);
    ASSERT_EQ(same.size(), meshes.size());
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        EXPECT_EQ(same[i].first, meshes[i].first);
        EXPECT_EQ(same[i].second.draco, meshes[i].second.draco);
        EXPECT_EQ(same[i].second.capture_time, meshes[i].second.capture_time);
    }
    const auto objects = samples_of<bus::SceneObject>(again);
    ASSERT_EQ(objects.size(), 2U);
    EXPECT_EQ(objects[0].second.name, "floor");
    EXPECT_EQ(objects[1].second.name, "ball");
    const auto states = samples_of<bus::SceneState>(again);
    EXPECT_NEAR(static_cast<double>(states.size()), 120.0, 2.0);  // 60 Hz
    for (const auto& [time, one] : states) {
        EXPECT_EQ(one.time, time);
        EXPECT_EQ(one.world, "rec");
        EXPECT_EQ(one.objects.size(), 2U);
    }
    EXPECT_GT(last_ball_x(again), 0.15);  // alice has pushed it
    const auto statuses = samples_of<bus::WorldStatus>(again);
    ASSERT_EQ(statuses.size(), 2U);  // one each second
    EXPECT_EQ(statuses[0].second.num_sites, 1U);
    // of recorded time, not the age of the recording
    EXPECT_LT(statuses[1].second.capture_to_collision.p99_ms, 40.0);
    const auto placements = samples_of<bus::SitePlacement>(again);
    EXPECT_EQ(placements.size(), 2U);

    // written again, it gives the same again
    WorldServerConfig third = config_of(again);
    EXPECT_EQ(run(third).last.hash, result.last.hash);
    // and never writes over a file
    const auto refused = RecordedRun::create(config);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::kConfiguration);
}

TEST(RecordedRun, ObeysRecordedCommandsUnlessToldNotTo) {
    FootRecording recording(file_named("commands"));
    recording.describe(0.0, "alice");
    recording.put_foot(0.01, "alice", {0, 1.5, 0.15});
    bus::SceneCommand push;
    push.sender = "viewer";
    push.kind = bus::CommandKind::kPush;
    push.target = 2;
    push.impulse_ns = {0.5, 0, 0};
    recording.write(0.5, push);
    recording.describe(1.5, "alice");
    recording.finish();
    WorldServerConfig config = config_of(recording.file());
    config.recording.output = file_named("pushed");
    fs::remove(config.recording.output);
    EXPECT_EQ(run(config).counts.num_rejected, 0U);
    EXPECT_GT(last_ball_x(config.recording.output), 0.3);
    config.recording.commands = false;
    config.recording.output = file_named("unpushed");
    fs::remove(config.recording.output);
    run(config);
    EXPECT_NEAR(last_ball_x(config.recording.output), 0.0, 0.01);
}

TEST(RecordedRun, KeepsThePlacesOfSitesThatTheWorldFileDoesNotName) {
    FootRecording recording(file_named("places"));
    recording.describe(0.0, "alice");
    recording.write(0.0, bus::SitePlacement{"alice", {Eigen::Quaterniond::Identity(), {1, 2, 0}}});
    recording.put_foot(0.01, "alice", {0, 0, 0.15});
    recording.finish();
    WorldServerConfig config = config_of(recording.file());
    for (const bool is_named : {false, true}) {
        if (!is_named)
            config.placements.clear();
        else
            config.placements = {{"alice", {Eigen::Quaterniond::Identity(), {-3, 0, 0}}}};
        config.recording.output = file_named("placed");
        fs::remove(config.recording.output);
        run(config);
        const auto placements = samples_of<bus::SitePlacement>(config.recording.output);
        ASSERT_EQ(placements.size(), 1U);
        EXPECT_EQ(placements[0].second.world_from_site.translation.x(), is_named ? -3.0 : 1.0);
    }
}

TEST(RecordedRun, EndsPeopleWhoseSiteLeft) {
    const auto contact_ticks = [](bool leaves) {
        FootRecording recording(file_named(leaves ? "leaves" : "stays"));
        recording.describe(0.0, "alice");
        recording.put_foot(0.01, "alice", {0, 0, 0.35});  // the ball falls on it
        bus::SiteDescription gone;
        gone.site = "alice";
        if (leaves) recording.write(0.5, gone, bus::RawKind::kDisposed);
        recording.describe(1.0, "bob");
        recording.finish();
        WorldServerConfig config = config_of(recording.file());
        config.objects[1].rigid.world_from_object.translation.z() = 1.2;
        return run(config).counts.num_contact_ticks;
    };
    EXPECT_GT(contact_ticks(false), 0U);
    EXPECT_LT(contact_ticks(true), contact_ticks(false));
}

TEST(RecordedRun, StopsWithACompleteOutput) {
    WorldServerConfig config = config_of(push_recording("stops"));
    config.recording.output = file_named("stopped");
    fs::remove(config.recording.output);
    auto created = RecordedRun::create(config);
    ASSERT_TRUE(created) << created.error().message;
    std::stop_source stop;
    const auto last =
        (*created)->run(stop.get_token(), [&](const RecordedState&) { stop.request_stop(); });
    ASSERT_TRUE(last) << last.error().message;
    EXPECT_EQ(last->tick, 120U);
    const auto states = samples_of<bus::SceneState>(config.recording.output);  // and no fault
    ASSERT_FALSE(states.empty());
    EXPECT_EQ(states.back().second.tick, 120U);
}

TEST(RecordedRun, RunsOnlyTheSecondsAskedFor) {
    WorldServerConfig config = config_of(push_recording("short"));
    config.seconds = 1.5;
    const Result result = run(config);
    EXPECT_EQ(result.last.tick, 180U);
    EXPECT_EQ(result.hashes.size(), 2U);
}

TEST(RecordedRun, SaysWhyARecordingIsOfNoUse) {
    const auto missing = RecordedRun::create(config_of("/nowhere/at/all.mcap"));
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().kind, ErrorKind::kNotFound);

    FootRecording empty(file_named("empty"));
    empty.write(0.0, bus::SceneState{"rec", 1, kRecordingBegin, {}});
    empty.finish();
    const auto nobody = RecordedRun::create(config_of(empty.file()));
    ASSERT_FALSE(nobody);
    EXPECT_NE(nobody.error().message.find("has no site"), std::string::npos);
    const auto checked = check_recording(config_of(empty.file()).recording);
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().message, nobody.error().message);
    EXPECT_TRUE(check_recording({}));

    // a site, but nothing of it that can be read
    FootRecording silent(file_named("silent"));
    silent.describe(0.0, "alice");
    silent.describe(1.0, "alice");
    silent.finish();
    auto created = RecordedRun::create(config_of(silent.file()));
    ASSERT_TRUE(created) << created.error().message;
    const auto done = (*created)->run({});
    ASSERT_FALSE(done);
    EXPECT_NE(done.error().message.find("no mesh could be read"), std::string::npos);
}

}  // namespace
}  // namespace atrium::world_server
