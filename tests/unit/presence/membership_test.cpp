#include "core/presence/membership.hpp"

#include "tests/unit/bus/bus_support.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <latch>
#include <mutex>
#include <thread>

namespace atrium::presence {
namespace {

using namespace std::chrono_literals;
using bus::BusOptions;
using bus::Participant;
using bus::Presence;
using bus::ProgramKind;
using bus::Writer;
using bus::testing::own_world;
using bus::testing::value;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// The messages of one member.
struct Said {
    std::mutex mutex;
    std::vector<std::string> lines;
    std::vector<Error> lost;

    MembershipEvents events() {
        const auto keep = [this](const std::string& line) {
            const std::lock_guard lock(mutex);
            lines.push_back(line);
        };
        return {keep, keep, [this](const Error& error) {
                    const std::lock_guard lock(mutex);
                    lost.push_back(error);
                }};
    }
    std::size_t num_lost() {
        const std::lock_guard lock(mutex);
        return lost.size();
    }
};

bool eventually(const std::function<bool()>& condition, std::chrono::seconds limit = 15s) {
    const auto end = std::chrono::steady_clock::now() + limit;
    while (!condition()) {
        if (std::chrono::steady_clock::now() > end) return false;
        std::this_thread::sleep_for(5ms);
    }
    return true;
}

auto join(const BusOptions& options, const std::string& name, Said& said) {
    const auto participant = value(Participant::create(options));
    return Membership::join(
        participant, {ProgramKind::kSiteNode, name, "1.2.3"}, said.events(), {});
}

TEST(Membership, ReportsWhoJoinedAndWhoLeft) {
    const BusOptions options = own_world("present", 120);
    Said said;
    const auto first = value(join(options, "lab", said));
    {
        const auto second = value(join(options, "studio", said));
        ASSERT_TRUE(eventually([&] { return first->present().size() == 2; }));
        const Presence other = first->present().back();
        EXPECT_EQ(other.name, "studio");
        EXPECT_EQ(other.kind, ProgramKind::kSiteNode);
        EXPECT_EQ(other.host, host_name());
        EXPECT_EQ(other.pid, static_cast<std::uint32_t>(::getpid()));
        EXPECT_EQ(other.version, "1.2.3");
        EXPECT_TRUE(eventually([&] { return first->present().back().is_holder; }));
    }
    EXPECT_TRUE(eventually([&] { return first->present().size() == 1; }));
    EXPECT_EQ(said.num_lost(), 0U);
}

TEST(Membership, SecondOfTheSameNameIsRefusedAndTheFirstStays) {
    const BusOptions options = own_world("refused", 121);
    Said first_said;
    Said second_said;
    const auto first = value(join(options, "lab", first_said));
    const std::uint64_t num_written = first->present().front().num_written;
    const auto second = join(options, "lab", second_said);
    EXPECT_GT(first->present().front().num_written, num_written) << "it answers";
    ASSERT_FALSE(second.has_value());
    EXPECT_EQ(second.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(second.error().message,
                AllOf(HasSubstr("'lab'"),
                      HasSubstr("host " + host_name()),
                      HasSubstr("pid " + std::to_string(::getpid()))));
    EXPECT_EQ(first_said.num_lost(), 0U);
    EXPECT_TRUE(eventually([&] { return first->present().size() == 1; }));
}

TEST(Membership, OneOfTwoSimultaneousJoinsSurvives) {
    for (int round = 0; round < 3; ++round) {
        const BusOptions options = own_world("instant" + std::to_string(round), 122);
        Said said[2];
        std::unique_ptr<Membership> members[2];
        {
            std::latch together(2);
            std::vector<std::jthread> threads;
            for (int i = 0; i < 2; ++i) {
                threads.emplace_back([&, i] {
                    const auto participant = value(Participant::create(options));
                    together.arrive_and_wait();
                    auto member = Membership::join(
                        participant, {ProgramKind::kSiteNode, "lab", "1"}, said[i].events(), {});
                    if (member) members[i] = std::move(*member);
                });
            }
        }
        const auto num_alive = [&] {
            int num = 0;
            for (int i = 0; i < 2; ++i) num += members[i] && said[i].num_lost() == 0;
            return num;
        };
        EXPECT_TRUE(eventually([&] { return num_alive() == 1; })) << round;
    }
}

// How a network that was cut and healed looks to the member that did not notice the cut.
TEST(Membership, GivesWayToAnOlderHolder) {
    const BusOptions options = own_world("healed", 123);
    Said said;
    const auto member = value(join(options, "lab", said));
    const auto elsewhere = value(Participant::create(options));
    auto writer = value(Writer<Presence>::create(elsewhere));
    Presence other = member->present().front();
    other.host = "omega";
    other.instance += 1;
    other.start_time = other.start_time + 1h;
    ASSERT_TRUE(writer.write(other));
    ASSERT_TRUE(eventually([&] { return member->present().size() == 2; }));
    EXPECT_EQ(said.num_lost(), 0U) << "must not give way to a younger holder";
    other.start_time = other.start_time + -2h;
    ASSERT_TRUE(writer.write(other));
    ASSERT_TRUE(eventually([&] { return said.num_lost() == 1; }));
    EXPECT_EQ(said.lost.front().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(said.lost.front().message, AllOf(HasSubstr("'lab'"), HasSubstr("omega")));
}

TEST(Membership, EndsWhenStoppedWhileAsking) {
    const auto participant = value(Participant::create(own_world("stopped", 124)));
    Said said;
    std::stop_source stop;
    stop.request_stop();
    const auto member = Membership::join(
        participant, {ProgramKind::kViewer, "v", "1"}, said.events(), stop.get_token());
    ASSERT_FALSE(member.has_value());
    EXPECT_EQ(member.error().kind, ErrorKind::kUnavailable);
}

TEST(Membership, AsksForTheWorldThatAMisspeltOneMayMean) {
    const BusOptions meant = own_world("playroom", 125);
    BusOptions written = meant;
    written.world.erase(written.world.size() - 2, 1);
    Said said;
    auto server = value(join(meant, "server", said));
    const auto lost = value(join(written, "lab", said));
    EXPECT_TRUE(eventually([&] {
        return lost->place().find("other_worlds=" + meant.world + " did_you_mean=" + meant.world) !=
               std::string::npos;
    })) << lost->place();
    // a world that nobody is in any more is not heard
    server.reset();
    EXPECT_TRUE(eventually([&] {
        return lost->place().find("other_worlds=") == std::string::npos;
    })) << lost->place();
}

}  // namespace
}  // namespace atrium::presence
