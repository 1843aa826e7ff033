#include "tools/monitor/world_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace atrium::monitor {
namespace {

using namespace std::chrono_literals;
using bus::Ending;
using bus::ProgramKind;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr Timestamp kStart{1'800'000'000'000'000'000};

bus::Presence presence(ProgramKind kind,
                       const std::string& name,
                       std::uint64_t instance,
                       const std::string& host = "alpha") {
    bus::Presence out;
    out.kind = kind;
    out.name = name;
    out.instance = instance;
    out.is_holder = true;
    out.host = host;
    out.pid = 17;
    out.version = "1.2.3";
    out.start_time = kStart;
    return out;
}

bus::Presence synchronised(bus::Presence presence, std::chrono::nanoseconds error) {
    presence.is_clock_synchronised = true;
    presence.clock_max_error = error;
    return presence;
}

bus::SiteStatus site_status(double seconds, std::uint64_t num_late) {
    bus::SiteStatus status;
    status.site = "lab";
    status.time = kStart + std::chrono::nanoseconds(static_cast<std::int64_t>(seconds * 1e9));
    status.num_metaframes_captured = 1000 + num_late;
    status.num_dropped_late = num_late;
    status.metaframes_per_s = 30.0;
    bus::CameraStatus camera;
    camera.name = "cam0";
    camera.num_received = 30 * num_late;
    camera.num_incomplete = num_late;
    status.cameras = {camera};
    return status;
}

bus::ViewerStatus viewer_status() {
    bus::ViewerStatus status;
    status.viewer = "wall";
    status.time = kStart;
    status.capture_to_display = {51.0, 60.0, 100};
    return status;
}

class Model : public testing::Test {
protected:
    Report report() { return model_.report(now_, kStart + 100s); }
    const ProgramReport& program(const std::string& name) {
        report_ = report();
        for (const ProgramReport& program : report_.programs) {
            if (program.name == name) return program;
        }
        ADD_FAILURE() << name << " is missing";
        static const ProgramReport nobody;
        return nobody;
    }
    static const Count& loss(const std::vector<Count>& losses, const std::string& what) {
        for (const Count& count : losses) {
            if (count.what == what) return count;
        }
        ADD_FAILURE() << what << " is missing";
        static const Count none;
        return none;
    }
    // a site and a viewer on two hosts, with a latency between them
    void see_two_hosts(const bus::Presence& site, const bus::Presence& viewer) {
        model_.see(site, now_);
        model_.see(viewer, now_);
        model_.see(site_status(0, 0), now_);
        model_.see(viewer_status(), now_);
    }

    WorldModel model_{"test"};
    WorldModel::Clock::time_point now_{1000s};
    Report report_;
};

TEST_F(Model, IsEmptyAtFirst) {
    EXPECT_EQ(report().num_here(), 0u);
    EXPECT_THAT(report().programs, IsEmpty());
    EXPECT_EQ(report().world, "test");
}

TEST_F(Model, ReportsProgramsAndTheirUptime) {
    model_.see(presence(ProgramKind::kSiteNode, "lab", 1), now_);
    EXPECT_FALSE(program("lab").has_status);
    EXPECT_DOUBLE_EQ(*program("lab").uptime_s, 100.0) << "uptime must use this host's clock";
    model_.see(site_status(42.0, 0), now_);
    now_ += 1s;
    const ProgramReport& lab = program("lab");
    EXPECT_EQ(lab.host, "alpha");
    EXPECT_EQ(lab.pid, 17u);
    EXPECT_EQ(lab.version, "1.2.3");
    EXPECT_DOUBLE_EQ(*lab.uptime_s, 43.0) << "uptime must use the program's clock";
    EXPECT_DOUBLE_EQ(lab.rate, 30.0);
}

TEST_F(Model, RatesUseTheProgramsClock) {
    model_.see(site_status(10.0, 100), now_);
    EXPECT_EQ(loss(program("lab").losses, "dropped_late").total, 100u);
    EXPECT_FALSE(loss(program("lab").losses, "dropped_late").per_s) << "a first report has no rate";
    now_ += 5s;  // the report arrives late
    model_.see(site_status(12.0, 110), now_);
    EXPECT_DOUBLE_EQ(*loss(program("lab").losses, "dropped_late").per_s, 5.0);
    EXPECT_DOUBLE_EQ(*program("lab").cameras[0].received.per_s, 150.0);
    EXPECT_DOUBLE_EQ(*loss(program("lab").cameras[0].losses, "incomplete").per_s, 5.0);
}

TEST_F(Model, RestartedCountersGiveNoRate) {
    model_.see(site_status(10.0, 100), now_);
    model_.see(site_status(11.0, 3), now_);  // restarted without a notice
    EXPECT_EQ(loss(program("lab").losses, "dropped_late").total, 3u);
    EXPECT_FALSE(loss(program("lab").losses, "dropped_late").per_s);
    EXPECT_FALSE(program("lab").cameras[0].received.per_s);
    model_.see(site_status(12.0, 4), now_);
    EXPECT_DOUBLE_EQ(*loss(program("lab").losses, "dropped_late").per_s, 1.0);
    model_.see(site_status(11.5, 5), now_);  // its clock was set back
    EXPECT_FALSE(loss(program("lab").losses, "dropped_late").per_s);
    model_.see(site_status(11.5, 6), now_);
    EXPECT_FALSE(loss(program("lab").losses, "dropped_late").per_s) << "no time has passed";
}

TEST_F(Model, NewProcessOfTheSameNameCountsSeparately) {
    model_.see(presence(ProgramKind::kSiteNode, "lab", 1), now_);
    model_.see(site_status(10.0, 100), now_);
    model_.gone(presence(ProgramKind::kSiteNode, "lab", 1), Ending::kDisposed, now_);
    model_.see(presence(ProgramKind::kSiteNode, "lab", 2), now_);
    EXPECT_EQ(program("lab").state, ProgramState::kPresent);
    EXPECT_FALSE(program("lab").has_status) << "figures of the previous process must be gone";
    model_.see(site_status(11.0, 200), now_);
    EXPECT_FALSE(loss(program("lab").losses, "dropped_late").per_s);
}

TEST_F(Model, ProgramsThatLeftAreShownForTenSecondsWithTheReason) {
    const auto lab = presence(ProgramKind::kSiteNode, "lab", 1);
    const auto wall = presence(ProgramKind::kViewer, "wall", 2);
    model_.see(lab, now_);
    model_.see(wall, now_);
    model_.gone(lab, Ending::kDisposed, now_);
    model_.gone(wall, Ending::kLost, now_);
    model_.see(site_status(1.0, 0), now_);  // a last status that arrives too late
    now_ += 9s;
    EXPECT_EQ(program("lab").state, ProgramState::kGone);
    EXPECT_DOUBLE_EQ(program("lab").gone_s, 9.0);
    EXPECT_EQ(program("lab").host, "alpha");
    EXPECT_THAT(program("lab").gone_reason, HasSubstr("ended"));
    EXPECT_THAT(program("wall").gone_reason, HasSubstr("killed"));
    EXPECT_EQ(report().num_here(), 0u);
    now_ += 1s;
    EXPECT_THAT(report().programs, IsEmpty());
}

TEST_F(Model, ProgramWithoutStatusIsSilent) {
    model_.see(presence(ProgramKind::kSiteNode, "lab", 1), now_);
    model_.see(site_status(1.0, 0), now_);
    now_ += 2900ms;
    EXPECT_EQ(program("lab").state, ProgramState::kPresent);
    now_ += 200ms;
    EXPECT_EQ(program("lab").state, ProgramState::kSilent);
    now_ += 1h;
    EXPECT_EQ(program("lab").state, ProgramState::kSilent) << "its presence is still announced";
}

TEST_F(Model, ProgramsOnOneHostShareAClock) {
    see_two_hosts(presence(ProgramKind::kSiteNode, "lab", 1),
                  presence(ProgramKind::kViewer, "wall", 2));
    EXPECT_EQ(program("wall").latencies[0].trust, ClockTrust::kOneClock);
    EXPECT_EQ(program("wall").latencies[0].error_ms, 0.0);
    EXPECT_THAT(report().notices, IsEmpty());
}

TEST_F(Model, ErrorsOfTwoSynchronisedClocksAddUp) {
    see_two_hosts(synchronised(presence(ProgramKind::kSiteNode, "lab", 1, "alpha"), 1ms),
                  synchronised(presence(ProgramKind::kViewer, "wall", 2, "beta"), 500us));
    EXPECT_EQ(program("wall").latencies[0].trust, ClockTrust::kSynchronised);
    EXPECT_DOUBLE_EQ(program("wall").latencies[0].error_ms, 1.5);
    EXPECT_EQ(program("lab").latencies.back().trust, ClockTrust::kOneClock)
        << "a latency of one program has one clock";
    EXPECT_THAT(report().notices, IsEmpty());
}

TEST_F(Model, LatenciesBetweenUnsynchronisedClocksAreUntrusted) {
    see_two_hosts(synchronised(presence(ProgramKind::kSiteNode, "lab", 1, "alpha"), 1ms),
                  presence(ProgramKind::kViewer, "wall", 2, "beta"));
    bus::StreamFeedback feedback;
    feedback.viewer = "wall";
    feedback.site = "lab";
    model_.see(feedback, now_);
    EXPECT_EQ(program("wall").latencies[0].trust, ClockTrust::kUnsynchronised);
    EXPECT_EQ(report().streams[0].delays[0].trust, ClockTrust::kUnsynchronised);
    EXPECT_THAT(report().notices,
                ElementsAre("clocks of alpha and beta are not synchronised (beta is not), "
                            "latencies between them mean nothing"));
}

TEST_F(Model, DistinguishesASlowViewerFromASlowNetwork) {
    bus::SiteStatus site = site_status(0, 0);
    model_.see(site, now_);
    site = site_status(1, 0);
    site.num_metaframes_captured += 30;
    site.processor.is_waiting_known = true;
    site.stream.num_dropped_for_rate = 15;
    site.stream.cap_bit_per_s = 4.2e6;
    site.stream.cap_set_by = "wall";
    model_.see(site, now_);
    bus::ViewerStatus viewer = viewer_status();
    viewer.processor.is_waiting_known = true;
    model_.see(viewer, now_);
    const std::string slow =
        "network too slow to wall: 15 of 30 metaframes left out for 4.2 Mbit/s";
    EXPECT_THAT(program("lab").bottlenecks,
                ElementsAre(status::Bottleneck{status::Cause::kNetwork, slow}));
    EXPECT_THAT(program("wall").bottlenecks, IsEmpty());
    viewer.processor.longest_wait_per_s = 0.7;
    model_.see(viewer, now_);
    EXPECT_THAT(
        program("lab").bottlenecks,
        ElementsAre(status::Bottleneck{status::Cause::kNetwork,
                                       slow + ", but the machine of that viewer is too slow"}));
    EXPECT_EQ(program("wall").bottlenecks.size(), 1U);
}

TEST_F(Model, SiteThatLeftDoesNotAffectTheLatency) {
    const auto site = presence(ProgramKind::kSiteNode, "lab", 1, "alpha");
    see_two_hosts(site, presence(ProgramKind::kViewer, "wall", 2, "beta"));
    model_.gone(site, Ending::kDisposed, now_);
    EXPECT_EQ(program("wall").latencies[0].trust, ClockTrust::kOneClock);
}

TEST_F(Model, UnknownHostIsNotTrusted) {
    model_.see(site_status(1.0, 0), now_);
    model_.see(viewer_status(), now_);
    EXPECT_EQ(program("wall").latencies[0].trust, ClockTrust::kUnknown);
    EXPECT_FALSE(program("wall").is_known);
    EXPECT_THAT(report().notices, ElementsAre(HasSubstr("unknown")));
}

TEST_F(Model, CountsStreamsAcrossReports) {
    bus::StreamFeedback feedback;
    feedback.viewer = "wall";
    feedback.site = "lab";
    feedback.num_complete = 6;
    feedback.num_incomplete = 1;
    for (int i = 0; i < 50; ++i) {
        model_.see(feedback, now_);
        now_ += 200ms;
    }
    now_ -= 200ms;
    const StreamReport stream = report().streams.at(0);
    EXPECT_EQ(stream.complete.total, 300u);
    EXPECT_DOUBLE_EQ(*stream.complete.per_s, 30.0);
    EXPECT_EQ(loss(stream.losses, "incomplete_pairs").total, 50u);
    EXPECT_DOUBLE_EQ(*loss(stream.losses, "incomplete_pairs").per_s, 5.0);
    now_ += 3s;
    EXPECT_TRUE(report().streams.at(0).is_silent);
    EXPECT_EQ(report().streams.at(0).complete.per_s, 0.0);
    model_.gone(feedback);
    EXPECT_THAT(report().streams, IsEmpty());
}

TEST_F(Model, MeasuredValuesReplaceReportedOnes) {
    bus::SiteStatus status = site_status(1.0, 0);
    status.mesh_bytes_per_s = 7.0;
    status.texture_bytes_per_s = 8.0;
    model_.see(status, now_);
    for (int i = 0; i < 60; ++i) {
        model_.measured("SiteMesh", ProgramKind::kSiteNode, "lab", 1000, now_);
        model_.measured("SiteMesh", ProgramKind::kSiteNode, "stranger", 1000, now_);
        now_ += 50ms;
    }
    now_ -= 50ms;
    ASSERT_EQ(program("lab").topics.size(), 2u);
    EXPECT_FALSE(program("lab").topics[0].is_measured);
    EXPECT_EQ(program("lab").topics[0].topic, "CameraTexture");
    EXPECT_TRUE(program("lab").topics[1].is_measured);
    EXPECT_DOUBLE_EQ(program("lab").topics[1].bytes_per_s, 20'000.0);
    EXPECT_DOUBLE_EQ(*program("lab").topics[1].samples_per_s, 20.0);
    EXPECT_EQ(report().programs.size(), 1u) << "samples of strangers must not create a program";
}

TEST_F(Model, ReportsTwoProgramsWithOneName) {
    model_.see(presence(ProgramKind::kSiteNode, "lab", 1), now_);
    bus::Presence other = presence(ProgramKind::kSiteNode, "lab", 2, "beta");
    other.is_holder = false;
    model_.see(other, now_);
    EXPECT_EQ(program("lab").host, "alpha") << "alpha holds the name";
    EXPECT_THAT(report().notices, ElementsAre(HasSubstr("2 processes")));
}

TEST_F(Model, MemoryStaysBounded) {
    bus::StreamFeedback feedback;
    for (int i = 0; i < 3000; ++i) {
        const std::string name = "n" + std::to_string(i);
        model_.see(presence(ProgramKind::kOther, name, 1), now_);
        model_.see(presence(ProgramKind::kOther, "same", static_cast<std::uint64_t>(i)), now_);
        feedback.viewer = name;
        feedback.site = "lab";
        model_.see(feedback, now_);
        model_.notice(name, now_);
    }
    EXPECT_EQ(report().programs.size(), WorldModel::kMaxPrograms);
    EXPECT_EQ(report().streams.size(), WorldModel::kMaxStreams);
    EXPECT_GT(report().num_left_out, 0u);
    EXPECT_LE(report().notices.size(), 2 * WorldModel::kMaxNotices + 1);
    // a program that leaves makes room for a new one
    model_.gone(presence(ProgramKind::kOther, "n0", 1), Ending::kLost, now_);
    model_.see(presence(ProgramKind::kSiteNode, "lab", 1), now_);
    EXPECT_EQ(program("lab").state, ProgramState::kPresent);
}

TEST_F(Model, ComparesTheNodesOfASiteWithItsModelPart) {
    const bus::HostStatus missing{.name = "north"};
    bus::SiteStatus status = site_status(0, 0);
    status.hosts = {missing};
    const bus::Presence site = presence(ProgramKind::kSiteNode, "lab", 1);
    model_.see(site, now_);
    model_.see(status, now_);
    ASSERT_EQ(program("lab").alarms.size(), 1u);
    EXPECT_THAT(program("lab").alarms[0].cure, HasSubstr("start camera_node on that host"));
    model_.see(presence(ProgramKind::kCameraNode, "lab.north", 2), now_);
    EXPECT_THAT(program("lab").alarms[0].cure, HasSubstr("prepares its pictures"));
    bus::CameraNodeStatus cameras;
    cameras.site = "lab";
    cameras.host = "north";
    cameras.time = kStart;
    model_.see(cameras, now_);
    EXPECT_THAT(program("lab").alarms[0].cure, HasSubstr("start camera_node on that host"));
    EXPECT_THAT(program("lab.north").alarms, IsEmpty());
    model_.see(presence(ProgramKind::kRegionNode, "lab.south", 3), now_);
    ASSERT_EQ(program("lab.south").alarms.size(), 1u);
    EXPECT_THAT(program("lab.south").alarms[0].what, HasSubstr("does not name this host"));
    model_.gone(site, Ending::kLost, now_);
    model_.see(presence(ProgramKind::kSiteNode, "hall", 4), now_);
    ASSERT_EQ(program("lab.north").alarms.size(), 1u);
    EXPECT_EQ(program("lab.north").alarms[0].what, "the model part of its site is missing");
}

TEST_F(Model, NoticesExpireAfterAMinute) {
    model_.notice("a stranger", now_);
    now_ += 30s;
    model_.notice("another", now_);
    EXPECT_THAT(report().notices, ElementsAre("a stranger", "another"));
    now_ += 40s;
    EXPECT_THAT(report().notices, ElementsAre("another"));
}

}  // namespace
}  // namespace atrium::monitor
