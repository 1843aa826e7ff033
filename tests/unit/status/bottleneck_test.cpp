#include "core/status/bottleneck.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::status {
namespace {

using std::chrono::seconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::Optional;
using testing::StartsWith;

const OverloadLog::Clock::time_point kStart{std::chrono::hours(1)};

ProcessorUse waiting(double longest_wait_per_s) {
    ProcessorUse use;
    use.run_per_s = 0.81;
    use.waited_per_s = 3.0 * longest_wait_per_s;
    use.longest_wait_per_s = longest_wait_per_s;
    use.is_waiting_known = true;
    return use;
}

// The status of a site, some seconds after its start.
bus::SiteStatus site_after(int second, std::uint64_t late_per_s, double longest_wait_per_s) {
    bus::SiteStatus status;
    status.time = Timestamp{} + seconds(1000 + second);
    status.num_metaframes_captured = 30U * static_cast<unsigned>(second);
    status.num_dropped_late = late_per_s * static_cast<unsigned>(second);
    status.processor = waiting(longest_wait_per_s);
    return status;
}

std::vector<Bottleneck> of_second_2(std::uint64_t late_per_s, double longest_wait_per_s) {
    return bottlenecks(figures_of(site_after(1, late_per_s, longest_wait_per_s)),
                       figures_of(site_after(2, late_per_s, longest_wait_per_s)));
}

TEST(Bottlenecks, AreEmptyIfAProgramKeepsUp) {
    EXPECT_THAT(of_second_2(0, 0.0), IsEmpty());
    EXPECT_THAT(of_second_2(1, 0.19), IsEmpty()) << "a hiccup";
}

TEST(Bottlenecks, BlameTheMachineIfAThreadWaitsForACore) {
    EXPECT_THAT(
        of_second_2(0, 0.25),
        ElementsAre(Bottleneck{Cause::kMachine,
                               "machine too slow: one thread waited 25 % of the time for a core"}));
    EXPECT_THAT(of_second_2(5, 0.43),
                ElementsAre(Bottleneck{Cause::kMachine,
                                       "machine too slow: one thread waited 43 % of the time for a "
                                       "core; 5 of 30 metaframes came too late for work"}));
}

TEST(Bottlenecks, BlameTheWorkIfCoresAreFree) {
    EXPECT_THAT(of_second_2(5, 0.02),
                ElementsAre(Bottleneck{Cause::kWork,
                                       "work takes longer than its period, though cores are free: "
                                       "5 of 30 metaframes came too late for work"}));
    bus::WorldStatus before;
    bus::WorldStatus now;
    now.num_steps = 100;
    now.num_skipped_ticks = 20;
    before.processor = now.processor = waiting(0.0);
    const auto found = bottlenecks(figures_of(before), figures_of(now));
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].cause, Cause::kWork);
    EXPECT_THAT(found[0].text, HasSubstr("20 of 120 steps were skipped"));
}

TEST(Bottlenecks, BlameNoWorkIfTheProgramStoodStill) {
    bus::WorldStatus before;
    bus::WorldStatus now;
    now.num_steps = 123;
    now.num_skipped_ticks = 3113;
    before.processor = waiting(0.0);
    now.processor = waiting(0.01);
    now.processor.run_per_s = 0.05;
    EXPECT_THAT(bottlenecks(figures_of(before), figures_of(now)),
                ElementsAre(Bottleneck{Cause::kStoodStill,
                                       "the program stood still: 3113 of 3236 steps were skipped; "
                                       "it used 0.05 cores and waited 1 % of the time for one"}));
    for (const double waited : {0.06, 0.9}) {
        now.processor.longest_wait_per_s = waited;
        EXPECT_EQ(bottlenecks(figures_of(before), figures_of(now))[0].cause, Cause::kMachine);
    }
}

TEST(Bottlenecks, BlameNobodyForTheWaitForALostHost) {
    bus::SiteStatus before = site_after(1, 0, 0.0);
    bus::SiteStatus now = site_after(2, 5, 0.0);
    now.processor.run_per_s = 0.1;
    EXPECT_EQ(bottlenecks(figures_of(before), figures_of(now))[0].cause, Cause::kStoodStill);
    before.hosts = {{.name = "helper", .state = bus::HostState::kInUse, .num_regions = 1}};
    now.hosts = before.hosts;
    now.hosts[0].state = bus::HostState::kMissing;
    EXPECT_THAT(bottlenecks(figures_of(before), figures_of(now)), IsEmpty());
    before.hosts = now.hosts;
    EXPECT_EQ(bottlenecks(figures_of(before), figures_of(now))[0].cause, Cause::kStoodStill)
        << "nobody waits for a host that is missing";
}

TEST(Bottlenecks, FindTheWaitOfALossInTheReportBefore) {
    bus::WorldStatus before;
    bus::WorldStatus now;
    now.num_steps = 110;
    now.num_skipped_ticks = 10;
    before.processor = waiting(0.3);
    now.processor = waiting(0.01);
    now.processor.run_per_s = 0.2;
    EXPECT_THAT(bottlenecks(figures_of(before), figures_of(now)),
                ElementsAre(Bottleneck{Cause::kMachine,
                                       "machine too slow: one thread waited 30 % of the time for a "
                                       "core; 10 of 120 steps were skipped"}));
    now.num_skipped_ticks = 0;
    EXPECT_THAT(bottlenecks(figures_of(before), figures_of(now)), IsEmpty())
        << "a wait that is over and cost nothing";
}

TEST(Bottlenecks, BlameNeitherIfTheKernelDoesNotCount) {
    bus::SiteStatus before = site_after(1, 5, 0.9);
    bus::SiteStatus now = site_after(2, 5, 0.9);
    before.processor.is_waiting_known = now.processor.is_waiting_known = false;
    const auto found = bottlenecks(figures_of(before), figures_of(now));
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].cause, Cause::kMachineOrWork);
}

TEST(Bottlenecks, BlameTheNetworkForOmittedMetaframes) {
    bus::SiteStatus before = site_after(1, 0, 0.0);
    bus::SiteStatus now = site_after(2, 0, 0.0);
    now.stream.num_dropped_for_rate = 15;
    now.stream.cap_bit_per_s = 4.2e6;
    now.stream.cap_set_by = "wall";
    EXPECT_THAT(bottlenecks(figures_of(before), figures_of(now)),
                ElementsAre(Bottleneck{
                    Cause::kNetwork,
                    "network too slow to wall: 15 of 30 metaframes left out for 4.2 Mbit/s"}));
    now.stream.cap_set_by = "stream.max_mbit_per_s";
    EXPECT_THAT(bottlenecks(figures_of(before), figures_of(now))[0].text,
                StartsWith("limited by stream.max_mbit_per_s: 15 of 30"));
}

TEST(Bottlenecks, DoNotBlameTheNetworkForLossesOfAStarvedViewer) {
    bus::ViewerStatus before;
    bus::ViewerStatus now;
    now.num_pairs_shown = 20;
    now.num_incomplete = 10;
    before.processor = now.processor = waiting(0.05);
    EXPECT_THAT(bottlenecks(figures_of(before), figures_of(now)),
                ElementsAre(Bottleneck{Cause::kNetwork,
                                       "network loses data: 10 of 30 pairs arrived incomplete"}));
    now.processor = waiting(0.6);
    EXPECT_THAT(
        bottlenecks(figures_of(before), figures_of(now)),
        ElementsAre(Bottleneck{Cause::kMachine,
                               "machine too slow: one thread waited 60 % of the time for a core"}));
}

TEST(Bottlenecks, IgnoreCountersOfARestartedProgram) {
    EXPECT_THAT(bottlenecks(figures_of(site_after(9, 5, 0.0)), figures_of(site_after(2, 5, 0.0))),
                IsEmpty());
    EXPECT_THAT(bottlenecks(std::nullopt, figures_of(site_after(2, 5, 0.0))), IsEmpty());
    EXPECT_EQ(bottlenecks(std::nullopt, figures_of(site_after(2, 5, 0.5))).size(), 1U);
}

TEST(OverloadLog, WarnsAtOnceAndThenEverMoreSeldom) {
    OverloadLog log(bus::ProgramKind::kSiteNode, {}, 1);
    const auto look = [&](int second, double longest_wait_per_s) {
        return log.look(figures_of(site_after(second, 0, longest_wait_per_s)),
                        kStart + seconds(second));
    };
    EXPECT_EQ(look(0, 0.1), std::nullopt);
    EXPECT_THAT(look(1, 0.5),
                Optional(std::string(
                    "machine_too_slow reason=\"machine too slow: one thread waited 50 % of "
                    "the time for a core\" cores=0.81 host_cores=1 "
                    "advice=\"run fewer programs on this host, lower "
                    "capture.rate_hz, or use fewer or smaller pictures\"")));
    std::vector<int> seconds_of_lines;
    for (int second = 2; second < 700; ++second) {
        if (look(second, 0.5)) seconds_of_lines.push_back(second);
    }
    EXPECT_THAT(seconds_of_lines, ElementsAre(6, 16, 36, 76, 156, 316, 476, 636));
    EXPECT_EQ(look(800, 0.1), std::nullopt);
    EXPECT_NE(look(900, 0.3), std::nullopt) << "at once after a calm";
    EXPECT_EQ(look(904, 0.3), std::nullopt);
    EXPECT_NE(look(905, 0.3), std::nullopt) << "from the shortest period again";
}

TEST(OverloadLog, NamesAnotherCauseAtOnce) {
    OverloadLog log(bus::ProgramKind::kWorldServer, {}, 1);
    bus::WorldStatus status;
    status.processor = waiting(0.3);
    EXPECT_THAT(log.look(figures_of(status), kStart), Optional(HasSubstr("machine_too_slow")));
    status.processor = waiting(0.0);
    status.processor.run_per_s = 0.1;
    EXPECT_EQ(log.look(figures_of(status), kStart + seconds(1)), std::nullopt);
    status.num_skipped_ticks = 480;
    EXPECT_THAT(log.look(figures_of(status), kStart + seconds(2)),
                Optional(HasSubstr("stood_still")));
    status.num_skipped_ticks = 960;
    EXPECT_EQ(log.look(figures_of(status), kStart + seconds(3)), std::nullopt);
}

TEST(OverloadLog, BlamesOtherProgramsThatUseMostOfTheHost) {
    OverloadLog log(bus::ProgramKind::kWorldServer, {}, 4);
    bus::WorldStatus status;
    status.processor = waiting(0.9);  // and runs on 0.81 cores of 4
    const auto line = log.look(figures_of(status), kStart);
    ASSERT_TRUE(line);
    EXPECT_THAT(*line, HasSubstr("advice=\"other programs use most of this host's cores"));
    EXPECT_THAT(*line, Not(HasSubstr("tick_hz"))) << "a slower world would wait just as long";
    status.processor.run_per_s = 3.2;
    EXPECT_THAT(*log.look(figures_of(status), kStart + seconds(9)), HasSubstr("world.tick_hz"));
}

TEST(OverloadLog, IgnoresNetworkLosses) {
    OverloadLog log(bus::ProgramKind::kViewer);
    bus::ViewerStatus status;
    status.processor = waiting(0.0);
    EXPECT_EQ(log.look(figures_of(status), kStart), std::nullopt);
    status.num_incomplete = 10;
    EXPECT_EQ(log.look(figures_of(status), kStart + seconds(1)), std::nullopt);
}

TEST(Advice, NamesOptionsOfTheProgram) {
    EXPECT_THAT(advice(Cause::kMachine, bus::ProgramKind::kViewer, 0.9), HasSubstr("view.width"));
    EXPECT_THAT(advice(Cause::kWork, bus::ProgramKind::kSiteNode, 0.9), HasSubstr("site.threads"));
    EXPECT_THAT(advice(Cause::kMachine, bus::ProgramKind::kSiteNode, 0.9),
                Not(HasSubstr("site.threads")))
        << "more threads would have to wait too";
    EXPECT_THAT(advice(Cause::kWork, bus::ProgramKind::kWorldServer, 0.9),
                HasSubstr("world.tick_hz"));
}

TEST(ProcessFields, ReportAKernelThatDoesNotCount) {
    ProcessorUse use = waiting(0.1);
    use.run_ns = 12'340'000'000;
    use.waited_ns = 400'000'000;
    EXPECT_EQ(process_fields(use, 1.234), "processor_s=12.3 waited_s=0.4 first_output_s=1.23");
    use.is_waiting_known = false;
    EXPECT_THAT(process_fields(use, 0.0), HasSubstr("waited_s=unknown"));
    EXPECT_THAT(processor_items(use), ElementsAre("0.81 cores", "waited ?", "nice 0"));
}

}  // namespace
}  // namespace atrium::status
