#include "core/bus/bus.hpp"

#include "tests/support/source_dir.hpp"
#include "tests/unit/bus/all_messages.hpp"
#include "tests/unit/bus/bus_support.hpp"
#include "tests/unit/bus/random_messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <string>
#include <thread>

namespace atrium::bus {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::Listener;
using testing::own_world;
using testing::Random;
using testing::random_message;
using testing::value;

SiteMesh mesh_of(const std::string& site, std::uint64_t frame_id, std::size_t num_bytes = 100) {
    SiteMesh mesh;
    mesh.site = site;
    mesh.frame_id = frame_id;
    mesh.draco.assign(num_bytes, static_cast<std::uint8_t>(frame_id));
    return mesh;
}

/// The profiles, with samples that no delay of this test can let expire.
std::filesystem::path profiles_without_lifespan() {
    std::ifstream stream(atrium::test::source_dir() + "/qos/profiles.xml");
    std::string text(std::istreambuf_iterator<char>(stream), {});
    text = std::regex_replace(text, std::regex("<lifespan>.*</lifespan>"), "");
    const std::filesystem::path file =
        ::testing::TempDir() + "bus_test_" + std::to_string(::getpid()) + ".xml";
    std::ofstream(file) << text;
    return file;
}

template <typename Message>
class EveryTopic : public ::testing::Test {};
TYPED_TEST_SUITE(EveryTopic, testing::AllMessages);

TYPED_TEST(EveryTopic, CarriesAMessageUnchanged) {
    const BusOptions options = own_world("every");
    const auto here = value(Participant::create(options));
    const auto there = value(Participant::create(options));
    auto writer = value(Writer<TypeParam>::create(here));
    Listener<TypeParam> listener(there);
    EXPECT_EQ(writer.num_readers(), 1);
    EXPECT_EQ(listener.reader.num_writers(), 1);
    Random random(11);
    for (std::size_t i = 1; i <= 20; ++i) {
        const auto message = random_message<TypeParam>(random);
        const auto size = writer.write(message);
        ASSERT_TRUE(size.has_value()) << size.error().message;
        EXPECT_GT(*size, 0U);
        ASSERT_TRUE(listener.await([&] { return listener.samples.size() == i; }));
        EXPECT_TRUE(testing::same(message, listener.samples.back()));
    }
    EXPECT_TRUE(listener.gone.empty());
    EXPECT_EQ(listener.num_rejected, 0U);
}

TEST(Bus, InstanceStaysWhileOneOfTwoWritersLives) {
    const BusOptions options = own_world("two-writers");
    const auto participant = value(Participant::create(options));
    Listener<SitePlacement> listener(participant);
    auto first = value(Writer<SitePlacement>::create(participant));
    ASSERT_TRUE(first.write({"a", {}}));
    {
        const auto elsewhere = value(Participant::create(options));
        auto second = value(Writer<SitePlacement>::create(elsewhere));
        ASSERT_TRUE(second.write({"a", {}}));
        ASSERT_TRUE(second.write({"b", {}}));
        ASSERT_TRUE(listener.await([&] { return listener.samples.size() >= 2; }));
    }
    ASSERT_TRUE(listener.await([&] { return !listener.gone.empty(); }));
    EXPECT_EQ(listener.gone.front().site, "b");
    // everything from the second writer has arrived before this
    ASSERT_TRUE(first.write({"c", {}}));
    ASSERT_TRUE(listener.await([&] { return listener.samples.back().site == "c"; }));
    for (const SitePlacement& key : listener.gone) EXPECT_EQ(key.site, "b");
}

TEST(Bus, WriteRefusesMessagesThatReadersRefuse) {
    const auto participant = value(Participant::create(own_world("refuse")));
    auto writer = value(Writer<SitePlacement>::create(participant));
    Listener<SitePlacement> listener(participant);
    SitePlacement placement;
    placement.site = "two words";
    const auto result = writer.write(placement);
    ASSERT_FALSE(result.has_value());
    EXPECT_EQ(result.error().kind, ErrorKind::kInvalidData);
    EXPECT_THAT(result.error().message, HasSubstr("SitePlacement.site"));
    EXPECT_FALSE(writer.dispose(placement).has_value());
    listener.take();
    EXPECT_TRUE(listener.samples.empty());
}

TEST(Bus, SlowReaderGetsTheNewestEightPerKeyInOrderAndBlocksNobody) {
    BusOptions options = own_world("newest");
    options.profiles_file = profiles_without_lifespan();
    const auto participant = value(Participant::create(options));
    auto writer = value(Writer<SiteMesh>::create(participant));
    Listener<SiteMesh> listener(participant);
    for (std::uint64_t frame = 1; frame <= 200; ++frame) {
        ASSERT_TRUE(writer.write(mesh_of("a", frame, 100'000)).has_value());
        ASSERT_TRUE(writer.write(mesh_of("b", frame + 1000, 100'000)).has_value());
    }
    std::filesystem::remove(options.profiles_file);
    listener.take();
    std::map<std::string, std::vector<std::uint64_t>> frames;
    for (const SiteMesh& mesh : listener.samples) frames[mesh.site].push_back(mesh.frame_id);
    EXPECT_THAT(frames["a"], ElementsAre(193, 194, 195, 196, 197, 198, 199, 200));
    EXPECT_THAT(frames["b"], ElementsAre(1193, 1194, 1195, 1196, 1197, 1198, 1199, 1200));
}

TEST(Bus, LateJoinerGetsTheLastDescriptionOfEachSite) {
    const BusOptions options = own_world("late");
    const auto early = value(Participant::create(options));
    auto writer = value(Writer<SitePlacement>::create(early));
    for (const double x : {1.0, 2.0, 3.0}) {
        for (const char* site : {"a", "b"}) {
            SitePlacement placement;
            placement.site = site;
            placement.world_from_site.translation.x() = x;
            ASSERT_TRUE(writer.write(placement).has_value());
        }
    }
    const auto late = value(Participant::create(options));
    Listener<SitePlacement> listener(late);
    ASSERT_TRUE(listener.await([&] { return listener.samples.size() == 2; }));
    for (const auto& placement : listener.samples)
        EXPECT_EQ(placement.world_from_site.translation.x(), 3.0);
}

TEST(Bus, LateJoinerGetsNoOldMesh) {
    const auto participant = value(Participant::create(own_world("volatile")));
    auto writer = value(Writer<SiteMesh>::create(participant));
    ASSERT_TRUE(writer.write(mesh_of("a", 1)).has_value());
    Listener<SiteMesh> listener(participant);
    ASSERT_TRUE(writer.write(mesh_of("a", 2)).has_value());
    ASSERT_TRUE(listener.await([&] { return !listener.samples.empty(); }));
    EXPECT_EQ(listener.samples.front().frame_id, 2U);
}

TEST(Bus, DisposeReportsTheKeyWhichCanReturn) {
    const auto participant = value(Participant::create(own_world("dispose")));
    auto writer = value(Writer<SceneObject>::create(participant));
    Listener<SceneObject> listener(participant);
    SceneObject object;
    object.object = 7;
    object.name = "ball";
    ASSERT_TRUE(writer.write(object).has_value());
    ASSERT_TRUE(listener.await([&] { return listener.samples.size() == 1; }));
    ASSERT_TRUE(writer.dispose(object).has_value());
    ASSERT_TRUE(listener.await([&] { return listener.gone.size() == 1; }));
    EXPECT_EQ(listener.gone.front().object, 7U);
    EXPECT_EQ(listener.endings.front(), Ending::kDisposed);
    ASSERT_TRUE(writer.write(object).has_value());
    ASSERT_TRUE(listener.await([&] { return listener.samples.size() == 2; }));
    EXPECT_EQ(listener.gone.size(), 1U);
}

TEST(Bus, UnreadLastSampleComesBeforeItsDispose) {
    const auto participant = value(Participant::create(own_world("unread")));
    auto writer = value(Writer<SceneObject>::create(participant));
    Listener<SceneObject> listener(participant);
    SceneObject object;
    object.object = 9;
    object.name = "last-words";
    ASSERT_TRUE(writer.write(object).has_value());
    ASSERT_TRUE(writer.dispose(object).has_value());
    ASSERT_TRUE(listener.await([&] { return !listener.gone.empty(); }));
    ASSERT_EQ(listener.samples.size(), 1U);
    EXPECT_EQ(listener.samples.front().name, "last-words");
    EXPECT_EQ(listener.gone.front().object, 9U);
    EXPECT_EQ(listener.endings.front(), Ending::kDisposed) << "disposed, after its last sample";
}

TEST(Bus, DestroyedWriterDisposesItsInstances) {
    const auto participant = value(Participant::create(own_world("destroyed")));
    Listener<SiteMesh> listener(participant);
    {
        auto writer = value(Writer<SiteMesh>::create(participant));
        ASSERT_TRUE(writer.write(mesh_of("a", 1)).has_value());
        ASSERT_TRUE(writer.write(mesh_of("b", 1)).has_value());
        ASSERT_TRUE(listener.await([&] { return listener.samples.size() == 2; }));
    }
    ASSERT_TRUE(listener.await([&] { return listener.gone.size() == 2; }));
    EXPECT_EQ(listener.reader.num_writers(), 0);
}

TEST(Bus, DisposedInstancesDoNotCountAgainstTheLimit) {
    const auto participant = value(Participant::create(own_world("limit")));
    auto writer = value(Writer<SceneObject>::create(participant));
    Listener<SceneObject> listener(participant);
    SceneObject object;
    object.name = "drop";
    for (object.object = 0; object.object < 10'000; ++object.object) {  // the profile allows 4096
        const auto result = writer.write(object);
        ASSERT_TRUE(result.has_value()) << object.object << ": " << result.error().message;
        ASSERT_TRUE(writer.dispose(object).has_value());
        listener.take();
    }
    EXPECT_EQ(listener.gone.size(), 10'000U);
}

TEST(Bus, WorldsAreIsolated) {
    const auto one = value(Participant::create(own_world("one")));
    const auto two = value(Participant::create(own_world("two")));
    auto writer = value(Writer<SiteMesh>::create(one));
    Listener<SiteMesh> same_world(one);
    Listener<SiteMesh> other_world(two);
    ASSERT_TRUE(writer.write(mesh_of("a", 1)).has_value());
    ASSERT_TRUE(same_world.await([&] { return !same_world.samples.empty(); }));
    other_world.take();
    EXPECT_TRUE(other_world.samples.empty());
    EXPECT_EQ(writer.num_readers(), 1);
    EXPECT_EQ(other_world.reader.num_writers(), 0);
}

TEST(Bus, PartsOfAWorldAreIsolated) {
    const auto world = value(Participant::create(own_world("parts")));
    auto writer = value(Writer<SiteMesh>::create(world, "hall/north"));
    auto same = value(Reader<SiteMesh>::create(world, "hall/north"));
    auto waiter = value(Waiter::create(world));
    waiter.add(same);
    std::vector<Reader<SiteMesh>> others;
    for (const std::string part : {"", "hall", "hall/south"})
        others.push_back(value(Reader<SiteMesh>::create(world, part)));
    ASSERT_TRUE(writer.write(mesh_of("a", 1)).has_value());
    std::size_t num_taken = 0;
    while (num_taken == 0) {
        ASSERT_TRUE(waiter.wait(60s));
        num_taken += same.take([](SiteMesh&&) {}).num_taken;
    }
    EXPECT_EQ(writer.num_readers(), 1);
    for (auto& other : others) {
        EXPECT_EQ(other.take([](SiteMesh&&) {}).num_taken, 0u);
        EXPECT_EQ(other.num_writers(), 0);
    }
}

TEST(Bus, CommandsArriveInOrderAndAFullReaderIsReported) {
    const auto participant = value(Participant::create(own_world("commands")));
    auto writer = value(Writer<SceneCommand>::create(participant));
    Listener<SceneCommand> listener(participant);
    SceneCommand command;
    command.sender = "viewer";
    std::uint32_t num_written = 0;
    Expected<std::size_t> result = 0;
    for (; num_written < 10'000; ++num_written) {
        command.target = num_written;
        result = writer.write(command);
        if (!result) break;
    }
    ASSERT_FALSE(result.has_value()) << "a reader that never takes must stay bounded";
    EXPECT_EQ(result.error().kind, ErrorKind::kUnavailable);
    EXPECT_EQ(num_written, 256U);
    listener.take();
    ASSERT_EQ(listener.samples.size(), num_written);
    for (std::uint32_t i = 0; i < num_written; ++i) ASSERT_EQ(listener.samples[i].target, i);
    EXPECT_TRUE(writer.write(command).has_value()) << "write must succeed once there is room";
}

TEST(Bus, ReadersKeepTheirParticipantAlive) {
    const BusOptions options = own_world("alive");
    auto listener = std::make_unique<Listener<SiteMesh>>(value(Participant::create(options)));
    auto writer = value(Writer<SiteMesh>::create(value(Participant::create(options))));
    ASSERT_TRUE(writer.write(mesh_of("a", 1)).has_value());
    EXPECT_TRUE(listener->await([&] { return !listener->samples.empty(); }));
}

TEST(Bus, ExceptionInACallbackLeaksNothingAndLosesNoLaterSample) {
    const auto participant = value(Participant::create(own_world("throw")));
    auto writer = value(Writer<SiteMesh>::create(participant));
    Listener<SiteMesh> listener(participant);
    for (std::uint64_t frame = 1; frame <= 20; ++frame) {
        ASSERT_TRUE(writer.write(mesh_of("a", frame)).has_value());
        EXPECT_THROW(listener.reader.take([](SiteMesh&&) { throw std::runtime_error("mine"); }),
                     std::runtime_error);
    }
    ASSERT_TRUE(writer.write(mesh_of("a", 21)).has_value());
    ASSERT_TRUE(listener.await([&] { return !listener.samples.empty(); }));
    EXPECT_EQ(listener.samples.back().frame_id, 21U);
}

TEST(Waiter, WakeEndsTheWaitOfAnotherThread) {
    const auto participant = value(Participant::create(own_world("wake")));
    auto waiter = value(Waiter::create(participant));
    bool result = true;
    std::jthread sleeper([&] { result = waiter.wait(60s); });
    waiter.wake();
    sleeper.join();
    EXPECT_FALSE(result);
    EXPECT_FALSE(waiter.wait(0ms)) << "one wake must end only one wait";
}

TEST(Waiter, ReturnsFalseAtTimeoutAndTrueWithASample) {
    const auto participant = value(Participant::create(own_world("timeout")));
    Listener<SiteMesh> listener(participant);
    EXPECT_FALSE(listener.waiter.wait(1ms));
    auto writer = value(Writer<SiteMesh>::create(participant));
    ASSERT_TRUE(writer.write(mesh_of("a", 1)).has_value());
    EXPECT_TRUE(listener.waiter.wait(10s));
    EXPECT_TRUE(listener.waiter.wait(0ms)) << "must stay true until the sample is taken";
    listener.take();
    EXPECT_FALSE(listener.waiter.wait(0ms));
}

TEST(Writer, CanBeUsedByTwoThreads) {
    const auto participant = value(Participant::create(own_world("threads")));
    auto writer = value(Writer<SiteMesh>::create(participant));
    Listener<SiteMesh> listener(participant);
    const auto publish = [&](const std::string& site) {
        for (std::uint64_t frame = 1; frame <= 300; ++frame)
            (void)writer.write(mesh_of(site, frame, 1000));
    };
    {
        const std::jthread a(publish, "a");
        const std::jthread b(publish, "b");
    }
    listener.take();
    std::map<std::string, std::uint64_t> newest;
    for (const auto& mesh : listener.samples) {
        newest[mesh.site] = mesh.frame_id;
        EXPECT_THAT(mesh.draco, ::testing::Each(static_cast<std::uint8_t>(mesh.frame_id)));
    }
    EXPECT_THAT(newest,
                ::testing::ElementsAre(::testing::Pair("a", 300U), ::testing::Pair("b", 300U)));
}

}  // namespace
}  // namespace atrium::bus
