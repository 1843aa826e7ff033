#include "core/bus/bus.hpp"
#include "core/bus/deadline_count.hpp"
#include "core/bus/entity.hpp"
#include "core/bus/participant.hpp"
#include "core/bus/topics.hpp"
#include "tests/support/source_dir.hpp"
#include "tests/unit/bus/bus_support.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <thread>

namespace atrium::bus {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::Listener;
using testing::own_world;
using testing::value;

std::vector<std::string> complaints(const Participant& participant, std::size_t num_wanted) {
    std::vector<std::string> all;
    const auto end = std::chrono::steady_clock::now() + 15s;
    while (all.size() < num_wanted && std::chrono::steady_clock::now() < end) {
        for (std::string& line : participant.take_mismatches()) all.push_back(std::move(line));
        std::this_thread::sleep_for(10ms);
    }
    return all;
}

TEST(Strangers, PeerWithOtherQosIsNamedOnceWithThePolicy) {
    BusOptions options = own_world("qos", 125);
    const auto here = value(Participant::create(options));
    const auto file = std::filesystem::temp_directory_path() /
                      ("atrium-strangers-" + std::to_string(::getpid()) + ".xml");
    {
        std::string text;
        std::ifstream in(atrium::test::source_dir() + "/qos/profiles.xml");
        text.assign(std::istreambuf_iterator<char>(in), {});
        for (std::size_t at = 0; (at = text.find("RELIABLE_RELIABILITY_QOS", at)) != text.npos;)
            text.replace(at, 24, "BEST_EFFORT_RELIABILITY_QOS");
        std::ofstream(file) << text;
    }
    BusOptions other = options;
    other.profiles_file = file;
    const auto there = value(Participant::create(other));
    std::filesystem::remove(file);
    Listener<SiteMesh> listener(here);
    auto writer = value(Writer<SiteMesh>::create(there));
    const auto lines = complaints(here, 1);
    ASSERT_EQ(lines.size(), 1U);
    EXPECT_THAT(lines.front(),
                AllOf(HasSubstr("topic=SiteMesh"),
                      HasSubstr("reliability"),
                      HasSubstr("pid " + std::to_string(::getpid()))));
    EXPECT_TRUE(here.take_mismatches().empty()) << "once";
    EXPECT_EQ(complaints(there, 1).size(), 1U) << "both sides must report it";
}

TEST(Strangers, ForeignTypeOnOurTopicIsNamedOnceAndHarmless) {
    const BusOptions options = own_world("type", 126);
    const auto here = value(Participant::create(options));
    Listener<SiteMesh> listener(here);
    auto writer = value(Writer<SiteMesh>::create(here));
    const auto there = value(Participant::create(options));
    // the type of another topic under this topic's name
    const auto topic = value(own(dds_create_topic(there.impl()->participant.get(),
                                                  &Topic<SitePlacement>::kDescriptor,
                                                  Topic<SiteMesh>::kName,
                                                  nullptr,
                                                  nullptr),
                                 "topic"));
    const auto foreign =
        value(own(dds_create_writer(
                      there.impl()->publisher.get(),
                      topic.get(),
                      make_writer_qos(there.impl()->profiles.find(kStream)->second.writer).get(),
                      nullptr),
                  "writer"));
    atrium_SitePlacement wire{};
    std::strcpy(wire.site, "a");
    ASSERT_GE(dds_write(foreign.get(), &wire), 0);
    const auto lines = complaints(here, 1);
    ASSERT_EQ(lines.size(), 1U);
    EXPECT_THAT(lines.front(),
                AllOf(HasSubstr("topic=SiteMesh"), HasSubstr("atrium::SitePlacement")));
    ASSERT_GE(dds_write(foreign.get(), &wire), 0);
    EXPECT_TRUE(here.take_mismatches().empty()) << "once";

    SiteMesh mesh;
    mesh.site = "b";
    ASSERT_TRUE(writer.write(mesh));
    ASSERT_TRUE(listener.await([&] { return !listener.samples.empty(); }));
    EXPECT_EQ(listener.samples.front().site, "b") << "good samples must pass";
    EXPECT_EQ(listener.num_rejected, 0U);
}

TEST(Strangers, OwnProgramsCauseNoComplaint) {
    const BusOptions options = own_world("own", 127);
    const auto here = value(Participant::create(options));
    const auto there = value(Participant::create(options));
    Listener<SiteMesh> listener(here);
    auto writer = value(Writer<SiteMesh>::create(there));
    SiteMesh mesh;
    mesh.site = "b";
    ASSERT_TRUE(writer.write(mesh));
    ASSERT_TRUE(listener.await([&] { return !listener.samples.empty(); }));
    EXPECT_TRUE(here.take_mismatches().empty());
    EXPECT_TRUE(there.take_mismatches().empty());
}

TEST(StaleData, IsNotDeliveredAfterItsLifespan) {
    const auto participant = value(Participant::create(own_world("stale", 128)));
    Listener<SiteMesh> meshes(participant);
    Listener<SitePlacement> placements(participant);
    auto mesh_writer = value(Writer<SiteMesh>::create(participant));
    auto placement_writer = value(Writer<SitePlacement>::create(participant));
    SiteMesh mesh;
    mesh.site = "old";
    ASSERT_TRUE(mesh_writer.write(mesh));
    ASSERT_TRUE(placement_writer.write({"old", {}}));
    const auto lifespan = participant.impl()->profiles.find(kStream)->second.writer.lifespan;
    std::this_thread::sleep_for(lifespan + 200ms);  // nobody takes meanwhile: that is under test
    meshes.take();
    EXPECT_TRUE(meshes.samples.empty());
    EXPECT_TRUE(meshes.gone.empty()) << "the site still exists";
    placements.take();
    EXPECT_EQ(placements.samples.size(), 1U) << "descriptions do not expire";
    mesh.site = "new";
    ASSERT_TRUE(mesh_writer.write(mesh));
    ASSERT_TRUE(meshes.await([&] { return !meshes.samples.empty(); }));
    EXPECT_EQ(meshes.samples.front().site, "new");
}

TEST(DeadlineCount, CountsWholePeriodsOfSilencePerKey) {
    const DeadlineCount::Clock::time_point start{1h};
    DeadlineCount count(1s);
    count.heard(1, start);
    count.heard(2, start);
    count.heard(1, start + 900ms);
    EXPECT_EQ(count.num_missed(), 0U);
    count.heard(2, start + 2500ms);
    EXPECT_EQ(count.num_missed(), 2U);
    count.gone(1);
    count.heard(1, start + 1h);
    EXPECT_EQ(count.num_missed(), 2U) << "a writer that left must not count";
}

}  // namespace
}  // namespace atrium::bus
