#include "viewer/ui/status_lines.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::viewer {
namespace {

using std::chrono::seconds;

const StatusLines::Clock::time_point kFirstLine{std::chrono::hours(1)};

bus::SiteStatus site_status(std::uint64_t num_late) {
    bus::SiteStatus status;
    status.time = Timestamp{std::int64_t{1'000'000'000} * std::int64_t(100 + num_late)};
    status.metaframes_per_s = 12.96;
    status.num_dropped_late = num_late;
    status.left_out.num_phantoms = 10 * num_late;
    status.stages = {7.61, 21.5, 7.9, 0.2};
    status.capture_to_publish = {47.6, 126.1, 512};
    return status;
}

std::vector<std::string> texts(const std::vector<HudLine>& lines) {
    std::vector<std::string> texts;
    for (const HudLine& line : lines) texts.push_back(line.text);
    return texts;
}

TEST(StatusLines, ShowTheTimeOfEachStage) {
    StatusLines lines;
    lines.add("alice", site_status(0), kFirstLine);
    bus::WorldStatus world;
    world.steps_per_s = 119.0;
    world.step = {0.8, 2.1, 512};
    world.capture_to_collision = {68.1, 143.1, 512};
    world.processor = {.run_per_s = 0.62,
                       .waited_per_s = 0.12,
                       .longest_wait_per_s = 0.08,
                       .is_waiting_known = true,
                       .nice = 3};
    lines.add("lab", world, kFirstLine);
    EXPECT_THAT(texts(lines.details()),
                testing::ElementsAre("site alice: 13.0 metaframes/s",
                                     "  cpu  0.00 cores  waited ?  nice 0",
                                     "  ms  silhouettes 7.6  hull 21.5  coding 7.9  publishing 0.2",
                                     "  ms  capture to publish 47.6 (99 %: 126.1)",
                                     "world lab: 119.0 steps/s",
                                     "  cpu  0.62 cores  waited 8 % (all threads 12 %)  nice 3",
                                     "  ms  step 0.8 (99 %: 2.1)",
                                     "  ms  capture to collision 68.1 (99 %: 143.1)"));
    EXPECT_TRUE(lines.warnings().empty());
}

TEST(StatusLines, WarnWhileTheWorldIsGone) {
    using std::chrono::milliseconds;
    StatusLines lines;
    EXPECT_FALSE(lines.watch_world(kFirstLine));
    EXPECT_TRUE(lines.warnings().empty()) << "no world was there before";
    lines.watch_world(kFirstLine + seconds(3));
    EXPECT_TRUE(lines.warnings().empty()) << "it may not be discovered yet";
    lines.watch_world(kFirstLine + seconds(5));
    EXPECT_THAT(texts(lines.warnings()),
                testing::ElementsAre("no world server in this world: no objects"));
    lines = StatusLines();
    EXPECT_FALSE(lines.watch_world(kFirstLine));
    EXPECT_FALSE(lines.has_world());
    EXPECT_FALSE(lines.watch_world(kFirstLine, kFirstLine));
    EXPECT_TRUE(lines.has_world());
    EXPECT_FALSE(lines.watch_world(kFirstLine + milliseconds(1600), kFirstLine + seconds(1)));
    EXPECT_TRUE(lines.has_world());
    EXPECT_FALSE(lines.watch_world(kFirstLine + milliseconds(2500), kFirstLine + seconds(1)));
    EXPECT_TRUE(lines.watch_world(kFirstLine + milliseconds(2510), kFirstLine + seconds(1)));
    EXPECT_FALSE(lines.has_world());
    EXPECT_FALSE(lines.watch_world(kFirstLine + seconds(10), kFirstLine + seconds(1)));
    EXPECT_THAT(texts(lines.warnings()),
                testing::ElementsAre("no world server for 9 s: objects stand still or are gone"));
    EXPECT_TRUE(lines.watch_world(kFirstLine + seconds(11), kFirstLine + seconds(11)));
    EXPECT_TRUE(lines.warnings().empty());
    EXPECT_TRUE(lines.has_world());
}

// The objects of a killed server vanish before its silence says so.
TEST(StatusLines, WarnAtOnceIfTheObjectsLoseTheirWriter) {
    using std::chrono::milliseconds;
    StatusLines lines;
    lines.watch_world(kFirstLine, kFirstLine);
    const auto lost = kFirstLine + milliseconds(300);
    EXPECT_TRUE(lines.watch_world(lost, kFirstLine, lost));
    EXPECT_FALSE(lines.has_world());
    EXPECT_THAT(texts(lines.warnings()),
                testing::ElementsAre("no world server: objects stand still or are gone"));
    lines.set_other_worlds({.heard = {"evening", "lab"}, .meant = {"evening"}});
    EXPECT_FALSE(lines.watch_world(lost + seconds(2), kFirstLine, lost));
    EXPECT_THAT(texts(lines.warnings()),
                testing::ElementsAre("no world server for 2 s: objects stand still or are gone. "
                                     "Did you mean evening? Backspace: other worlds"));
    const auto back = lost + seconds(3);
    EXPECT_TRUE(lines.watch_world(back, back, lost));
    EXPECT_TRUE(lines.warnings().empty());
}

TEST(StatusLines, NameTheWorldThatIsMeantInsteadOfAnEmptyOne) {
    StatusLines lines;
    const std::vector<std::string> near{"evening", "eventing"};
    lines.set_other_worlds({.heard = near, .meant = near});
    lines.watch_world(kFirstLine);
    lines.watch_world(kFirstLine + seconds(5));
    EXPECT_THAT(texts(lines.warnings()),
                testing::ElementsAre("no world server in this world: no objects. Did you mean "
                                     "evening, eventing? Backspace: other worlds"));
    lines.set_other_worlds({.heard = {"lab"}, .meant = {}});
    EXPECT_THAT(texts(lines.warnings()),
                testing::ElementsAre("no world server in this world: no objects. Heard elsewhere: "
                                     "lab. Backspace: other worlds"));
}

TEST(StatusLines, WarnOfLossesSinceThePreviousReport) {
    StatusLines lines;
    lines.add("alice", site_status(100), kFirstLine);
    EXPECT_TRUE(lines.warnings().empty()) << "losses before the first report must not warn";
    lines.add("alice", site_status(103), kFirstLine + seconds(1));
    const auto warnings = lines.warnings();
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_TRUE(warnings[0].is_warning);
    EXPECT_EQ(warnings[0].text, "site alice: dropped late 3") << "phantoms are the site's affair";
    lines.add("alice", site_status(103), kFirstLine + seconds(2));
    EXPECT_TRUE(lines.warnings().empty());
    lines.add("alice", site_status(2), kFirstLine + seconds(3));
    EXPECT_TRUE(lines.warnings().empty()) << "a restart must not warn";
    bus::SiteStatus status = site_status(2);
    status.cameras.resize(3);
    status.cameras[1].connected = true;
    lines.add("bob", status, kFirstLine);
    EXPECT_THAT(texts(lines.warnings()), testing::ElementsAre("site bob: 2 cameras off"));
}

TEST(StatusLines, DistinguishASlowMachineFromASlowNetwork) {
    StatusLines lines;
    bus::SiteStatus site;
    site.processor.is_waiting_known = true;
    lines.add("alice", site, kFirstLine);
    site.num_metaframes_captured = 30;
    site.stream.num_dropped_for_rate = 15;
    site.stream.cap_set_by = "wall";
    site.stream.cap_bit_per_s = 4.2e6;
    lines.add("alice", site, kFirstLine + seconds(1));
    bus::ViewerStatus own;
    own.processor.is_waiting_known = true;
    own.processor.longest_wait_per_s = 0.5;
    lines.add_own(own, kFirstLine + seconds(1));
    EXPECT_THAT(
        texts(lines.warnings()),
        testing::ElementsAre(
            "site alice: network too slow to wall: 15 of 30 metaframes left out for 4.2 Mbit/s",
            "this viewer: machine too slow: one thread waited 50 % of the time for a core"));
}

TEST(StatusLines, WarnOfACameraThatWasMovedAsLongAsItsSiteSaysSo) {
    StatusLines lines;
    bus::SiteStatus lab = site_status(100);
    lab.coherence = {bus::RigVerdict::kMoved,
                     0.39,
                     48,
                     {{"south", 0.4, 0.98, 351}, {"north", 2.19, 0.66, 340}},
                     {.camera = 1, .turned_deg = 0.2, .cure = "calibrate refine lab.toml"}};
    lines.add("alice", site_status(100), kFirstLine);
    lines.add("lab", lab, kFirstLine);
    const std::string alarm =
        "site lab: camera north was moved (turned by 0.20 degrees): calibrate refine";
    EXPECT_THAT(texts(lines.warnings()), testing::ElementsAre(alarm)) << "with the first report";
    EXPECT_TRUE(lines.warnings()[0].is_warning);
    lines.add("alice", site_status(103), kFirstLine + seconds(1));
    lines.add("lab", lab, kFirstLine + seconds(1));
    EXPECT_THAT(texts(lines.warnings()), testing::ElementsAre(alarm, "site alice: dropped late 3"))
        << "above what comes and goes";
    const auto details = texts(lines.details());
    EXPECT_THAT(details,
                testing::Contains("  rig  moved  0.39 px  worst north 2.19 px  48 instants"));
    EXPECT_EQ(details.back(), "  mend  calibrate refine lab.toml");
    lab.coherence.verdict = bus::RigVerdict::kCoherent;
    lines.add("lab", lab, kFirstLine + seconds(2));
    lines.add("alice", site_status(103), kFirstLine + seconds(2));
    EXPECT_TRUE(lines.warnings().empty());
    EXPECT_EQ(texts(lines.details()).back(),
              "  rig  coherent  0.39 px  worst north 2.19 px  48 instants");
}

TEST(StatusLines, ShowTheWorldServerAndItsRefusals) {
    StatusLines lines;
    EXPECT_FALSE(lines.has_world());
    lines.add("alice", site_status(0), kFirstLine);
    EXPECT_FALSE(lines.has_world());
    bus::WorldStatus world;
    world.num_refused = 5;
    lines.add("lab", world, kFirstLine);
    lines.watch_world(kFirstLine, kFirstLine);
    lines.add("alice", site_status(0), kFirstLine + seconds(3));
    EXPECT_TRUE(lines.has_world());
    EXPECT_EQ(lines.num_refused(), 5U);
    lines.forget_silent(kFirstLine + seconds(5));
    lines.watch_world(kFirstLine + seconds(5));
    EXPECT_FALSE(lines.has_world());
    EXPECT_EQ(texts(lines.details()).size(), 4U) << "the site must still be shown";
}

TEST(StatusLines, AreBounded) {
    StatusLines lines;
    for (int i = 0; i < 1000; ++i) lines.add("s" + std::to_string(i), site_status(0), kFirstLine);
    EXPECT_LE(lines.details().size(), 4U * 128U);
}

}  // namespace
}  // namespace atrium::viewer
