#include "tools/monitor/render_json.hpp"
#include "tools/monitor/render_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <limits>
#include <string>

namespace atrium::monitor {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::HasSubstr;
using testing::Not;
using testing::ResultOf;

ProgramReport site(const std::string& name, int num_cameras) {
    ProgramReport out;
    out.kind = bus::ProgramKind::kSiteNode;
    out.name = name;
    out.is_known = true;
    out.host = "alpha";
    out.pid = 17;
    out.version = "1.2.3";
    out.uptime_s = 90061.0;
    out.clock = ClockReport{true, 0.5};
    out.has_status = true;
    out.rate_unit = "metaframes/s";
    out.rate = 29.97;
    out.losses = {{"dropped_late", 5, 0.25}, {"failed", 0, 0.0}};
    out.latencies = {{"hull", 3.14, {}, 1, ClockTrust::kOneClock, 0.0},
                     {"capture_to_publish", 14.2, 20.1, 100, ClockTrust::kOneClock, 0.0}};
    out.topics = {{"SiteMesh", 510'000.0, {}, false}, {"CameraTexture", 1'510'000.0, 240.0, true}};
    out.stream = bus::StreamState{65, 2, 1, 20.1e6, "wall", 3};
    out.resident_bytes = 250'000'000;
    out.processor = {.run_ns = 12'500'000'000,
                     .waited_ns = 2'500'000'000,
                     .run_per_s = 0.81,
                     .waited_per_s = 1.21,
                     .longest_wait_per_s = 0.43,
                     .is_waiting_known = true,
                     .nice = -2};
    out.first_output_s = 2.5;
    out.bottlenecks = {{status::Cause::kMachine, "machine too slow: waited 43 % of the time"}};
    for (int i = 0; i < num_cameras; ++i) {
        CameraReport camera;
        camera.name = "cam" + std::to_string(i);
        camera.connected = i != 1;
        camera.received = {"received", 300, 30.0};
        camera.offset_ms = 0.1;
        camera.last_picture_age_ms = i == 1 ? -1.0 : 12.0;
        camera.losses = {{"incomplete", 4, 0.0}, {"late", 0, 0.0}};
        out.cameras.push_back(camera);
    }
    return out;
}

ProgramReport viewer(ClockTrust trust) {
    ProgramReport out;
    out.kind = bus::ProgramKind::kViewer;
    out.name = "wall";
    out.has_status = true;
    out.rate_unit = "frames/s";
    out.rate = 60.0;
    out.latencies = {{"capture_to_display", 51.0, 60.2, 100, trust, 1.5}};
    return out;
}

Report whole_report(ClockTrust trust = ClockTrust::kSynchronised) {
    Report report;
    report.world = "atrium";
    report.time = {1'800'000'000'000'000'000};
    report.programs = {site("alice", 3), viewer(trust)};
    report.streams = {{"wall",
                       "alice",
                       false,
                       1.9e6,
                       {"complete", 300, 29.5},
                       {{"incomplete_pairs", 7, 1.5}, {"late_samples", 0, 0.0}},
                       {{"capture_to_complete", 40.0, {}, 6, trust, 1.5}}}};
    return report;
}

std::string text(const Report& report, TextOptions options = {}) {
    if (options.width == 80) options.width = 200;
    std::string all;
    for (const std::string& line : render_text(report, options)) all += line + "\n";
    return all;
}

TEST(RenderText, ShowsRatesAndLossesOfPrograms) {
    const std::string shown = text(whole_report());
    for (const char* part :
         {"world atrium",
          "sites 1",
          "world servers 0",
          "site alice  on alpha pid 17, 1.2.3, up 1 d 1:01:01, 250 MB",
          "30.0 metaframes/s  SiteMesh 510.0 kB/s  CameraTexture 1.51 MB/s 240.0 samples/s, "
          "measured",
          "hull 3.1  capture to publish 14.2 (p99 20.1)",
          "quality 65  resolution 1/2  rate 1/1  cap 20.1 Mbit/s  set by wall",
          "cpu      0.81 cores  waited 43 % (all threads 121 %)  nice -2\n",
          "cpu      0.00 cores  waited ?  nice 0\n",
          "dropped late 5 (0.2/s)",
          "slow     machine too slow: waited 43 % of the time\n",
          "cam0               30.0       12       0.1  incomplete 4",
          "NOT CONNECTED",
          "viewer wall",
          "from alice  29.5 frames/s  1.90 MB/s  capture to complete 40.0 +- 1.5  "
          "lost incomplete pairs 7 (1.5/s)"}) {
        EXPECT_THAT(shown, HasSubstr(part));
    }
    EXPECT_THAT(shown, Not(HasSubstr("failed"))) << "zero losses must be hidden";
}

ProgramReport site_of_a_moved_camera() {
    bus::SiteStatus status;
    status.coherence = {bus::RigVerdict::kMoved,
                        0.39,
                        48,
                        {{"north", 0.4, 0.98, 351}, {"south", 2.19, 0.66, 340}},
                        {.camera = 1, .turned_deg = 1.01, .effect_px = 2.0, .cure = "cure it;"}};
    const Figures figures = figures_of(status);
    ProgramReport out = site("lab", 0);
    out.coherence = figures.coherence;
    out.alarms = figures.alarms;
    return out;
}

TEST(RenderText, ShowsACameraThatWasMovedAndItsCure) {
    Report report = whole_report();
    EXPECT_THAT(text(report), AllOf(Not(HasSubstr("  rig ")), Not(HasSubstr("  mend "))));
    report.programs.push_back(site_of_a_moved_camera());
    EXPECT_THAT(text(report),
                AllOf(HasSubstr("  rig      moved  0.39 px  worst south 2.19 px  48 instants\n"),
                      HasSubstr("  mend     camera south was moved (turned by 1.01 degrees): cure "
                                "it;\n")));
    TextOptions options;
    options.colour = true;
    EXPECT_THAT(text(report, options), HasSubstr("\033[33m  mend     camera south"));
}

TEST(RenderJson, HasTheCoherenceOfTheRig) {
    Report report = whole_report();
    report.programs.push_back(site_of_a_moved_camera());
    auto json = nlohmann::json::parse(render_json(report));
    EXPECT_TRUE(json["programs"][1]["coherence"].is_null());
    EXPECT_TRUE(json["programs"][1]["alarms"].empty());
    const auto& lab = json["programs"][2];
    EXPECT_EQ(lab["alarms"][0]["text"], "camera south was moved (turned by 1.01 degrees)");
    EXPECT_EQ(lab["alarms"][0]["cure"], "cure it;");
    const auto& rig = lab["coherence"];
    EXPECT_EQ(rig["verdict"], "moved");
    EXPECT_EQ(rig["rms_px"], 0.39);
    EXPECT_EQ(rig["instants"], 48);
    EXPECT_EQ(rig["cameras"][1],
              nlohmann::json(
                  {{"name", "south"}, {"rms_px", 2.19}, {"share", 0.66}, {"tangencies", 340}}));
    EXPECT_EQ(rig["fault"]["camera"], "south");
    EXPECT_EQ(rig["fault"]["turned_deg"], 1.01);
    EXPECT_TRUE(rig["fault"]["moved_mm"].is_null());
    EXPECT_EQ(rig["fault"]["is_either"], false);
    EXPECT_EQ(rig["fault"]["effect_px"], 2.0);
    EXPECT_EQ(rig["fault"]["cure"], "cure it;");
    report.programs[2].coherence = bus::RigCoherence{};
    json = nlohmann::json::parse(render_json(report));
    EXPECT_EQ(json["programs"][2]["coherence"]["verdict"], "unknown");
    EXPECT_TRUE(json["programs"][2]["coherence"]["rms_px"].is_null());
    EXPECT_TRUE(json["programs"][2]["coherence"]["fault"].is_null());
}

TEST(RenderText, NamesSitesOfTheCommandLineThatAreMissing) {
    const TextOptions options{.sites = {"alice", "nobody"}};
    const std::string shown = text(whole_report(), options);
    EXPECT_THAT(shown, HasSubstr("! no site 'nobody' is there; there are: alice\n"));
    EXPECT_THAT(shown, Not(HasSubstr("no site 'alice'")));
    EXPECT_THAT(text(whole_report()), Not(HasSubstr("no site")));
    Report empty = whole_report();
    empty.programs.clear();
    EXPECT_THAT(text(empty, options), HasSubstr("! no site 'alice' is there, nor any other\n"));
}

TEST(RenderText, ShowsHowFarLatenciesCanBeTrusted) {
    EXPECT_THAT(text(whole_report(ClockTrust::kSynchronised)),
                HasSubstr("capture to display 51.0 (p99 60.2) +- 1.5"));
    EXPECT_THAT(text(whole_report(ClockTrust::kUnsynchronised)),
                HasSubstr("capture to display 51.0? (p99 60.2?)\n"));
    EXPECT_THAT(text(whole_report(ClockTrust::kUnknown)), HasSubstr("capture to display 51.0?"));
    EXPECT_THAT(text(whole_report(ClockTrust::kOneClock)),
                HasSubstr("capture to display 51.0 (p99 60.2)\n"));
    Report report = whole_report();
    report.programs[1].latencies[0].num_samples = 0;
    EXPECT_THAT(text(report), HasSubstr("capture to display -\n"));
}

TEST(RenderText, FitsLinesToTheTerminal) {
    Report report = whole_report();
    report.notices = {"clocks of " + std::string(63, 'a') + " and beta are not synchronised, " +
                      "latencies between them mean nothing"};
    report.programs[0].name = std::string(63, 'n');
    for (std::size_t width = kMinWidth; width < 180; ++width) {
        EXPECT_THAT(
            render_text(report, {width, 0, false, {}}),
            Each(ResultOf([](const std::string& s) { return s.size(); }, testing::Le(width))))
            << width;
    }
    EXPECT_GT(render_text(report, {40, 0, false, {}}).size(),
              render_text(report, {180, 0, false, {}}).size())
        << "the rest must continue on the next line";
    EXPECT_EQ(render_text(report, {3, 0, false, {}}),
              render_text(report, {kMinWidth, 0, false, {}}));
}

TEST(RenderText, ShowsCamerasIfTheyFitOrOnDemand) {
    Report report = whole_report();
    report.programs.push_back(site("bob", 3));
    const auto all = render_text(report, {120, 0, false, {}});
    const auto fewer = render_text(report, {120, all.size() - 1, false, {}});
    EXPECT_THAT(all, Contains(HasSubstr("cam0")));
    EXPECT_THAT(fewer, Not(Contains(HasSubstr("cam0"))));
    EXPECT_EQ(fewer.size(), all.size() - 8) << "without two tables of a heading and three cameras";
    const auto one = render_text(report, {120, all.size() - 1, false, {"bob"}});
    EXPECT_EQ(one.size(), all.size() - 4);
    for (const std::size_t height : {1u, 5u, 9u}) {
        const auto cut = render_text(report, {120, height, false, {}});
        EXPECT_EQ(cut.size(), height);
        EXPECT_THAT(cut.back(), HasSubstr("taller window"));
    }
}

TEST(RenderText, PassesNoForeignEscapesToTheTerminal) {
    Report report = whole_report();
    const std::string evil =
        "\033[2J\a\x9b"
        "5m\r\n\b\x7f\xc3\xa9";
    report.world = evil;
    report.notices = {evil};
    report.programs[0].name = report.programs[0].host = report.programs[0].version = evil;
    report.programs[0].rate_unit = report.programs[0].cameras[0].name = evil;
    report.programs[0].losses[0].what = report.programs[0].stream->cap_set_by = evil;
    report.programs[1].state = ProgramState::kGone;
    report.programs[1].gone_reason = evil;
    report.streams[0].site = evil;
    for (const std::string& line : render_text(report, {100, 0, false, {}})) {
        for (const char c : line) EXPECT_TRUE(c >= ' ' && c <= '~') << line;
    }
    // with colours, every escape is one of the renderer's: ESC [ digits m
    for (const std::string& line : render_text(report, {100, 0, true, {}})) {
        for (std::size_t at = line.find('\033'); at != std::string::npos;
             at = line.find('\033', at + 1)) {
            const std::size_t end = line.find_first_not_of("[0123456789", at + 1);
            EXPECT_TRUE(end != std::string::npos && line[end] == 'm' && end - at <= 5) << line;
        }
    }
}

TEST(RenderText, UsesColoursOnlyOnRequest) {
    EXPECT_THAT(text(whole_report()), Not(HasSubstr("\033")));
    TextOptions options;
    options.colour = true;
    EXPECT_THAT(text(whole_report(), options), HasSubstr("\033[1msite alice"));
    Report report = whole_report();
    report.programs[0].state = ProgramState::kGone;
    report.programs[0].gone_s = 4.0;
    report.programs[0].gone_reason = "it ended";
    EXPECT_THAT(text(report, options),
                HasSubstr("\033[31msite alice  on alpha pid 17, 1.2.3  GONE for 4 s: it ended"));
}

TEST(RenderText, ShowsAnUnknownRateNotAsZero) {
    Report report = whole_report();
    report.programs[0].cameras[0].received.per_s.reset();
    report.programs[0].losses[0].per_s.reset();
    EXPECT_THAT(text(report),
                AllOf(HasSubstr("cam0                  -"), HasSubstr("dropped late 5\n")));
    const auto json = nlohmann::json::parse(render_json(report));
    EXPECT_TRUE(json["programs"][0]["losses"]["dropped_late"]["per_s"].is_null());
}

TEST(RenderText, ReportsAnEmptyWorld) {
    Report report;
    report.world = "atrium";
    EXPECT_THAT(text(report), HasSubstr("nobody is there"));
}

TEST(RenderText, ShowsFiguresOfAnySize) {
    Report report = whole_report();
    report.programs[0].uptime_s = std::numeric_limits<double>::infinity();
    report.programs[0].rate = 1e300;
    report.programs[0].losses[0].total = std::numeric_limits<std::uint64_t>::max();
    report.time.ns = std::numeric_limits<std::int64_t>::max();
    EXPECT_THAT(text(report), HasSubstr("18446744073709551615"));
}

TEST(RenderJson, IsOneLineWithStableKeys) {
    const std::string line = render_json(whole_report());
    EXPECT_EQ(line.find('\n'), std::string::npos);
    const auto json = nlohmann::json::parse(line);
    EXPECT_EQ(json["world"], "atrium");
    EXPECT_EQ(json["num_here"], 2);
    const auto& alice = json["programs"][0];
    EXPECT_EQ(alice["kind"], "site");
    EXPECT_EQ(alice["name"], "alice");
    EXPECT_EQ(alice["state"], "present");
    EXPECT_EQ(alice["pid"], 17);
    EXPECT_EQ(alice["clock"]["synchronised"], true);
    EXPECT_EQ(alice["rate_unit"], "metaframes/s");
    EXPECT_EQ(alice["losses"]["failed"]["total"], 0) << "zero losses must be present";
    EXPECT_EQ(alice["losses"]["dropped_late"]["per_s"], 0.25);
    EXPECT_EQ(alice["latencies"]["hull"]["median_ms"], 3.14);
    EXPECT_TRUE(alice["latencies"]["hull"]["p99_ms"].is_null());
    EXPECT_EQ(alice["topics"]["SiteMesh"]["source"], "reported");
    EXPECT_EQ(alice["topics"]["CameraTexture"]["source"], "measured");
    EXPECT_EQ(alice["stream_level"]["cap_set_by"], "wall");
    EXPECT_EQ(alice["processor"]["cores"], 0.81);
    EXPECT_EQ(alice["processor"]["run_s"], 12.5);
    EXPECT_EQ(alice["processor"]["waited_s"], 2.5);
    EXPECT_EQ(alice["processor"]["longest_wait_per_s"], 0.43);
    EXPECT_EQ(alice["processor"]["nice"], -2);
    EXPECT_EQ(alice["first_output_s"], 2.5);
    EXPECT_EQ(alice["bottlenecks"][0]["cause"], "machine_too_slow");
    EXPECT_EQ(alice["cameras"].size(), 3u);
    EXPECT_TRUE(alice["cameras"][1]["last_picture_age_ms"].is_null());
    const auto& wall = json["programs"][1];
    EXPECT_TRUE(wall["host"].is_null());
    EXPECT_EQ(wall["processor"]["cores"], 0.0);
    EXPECT_TRUE(wall["processor"]["waited_per_s"].is_null()) << "the wait is unknown";
    EXPECT_TRUE(wall["first_output_s"].is_null());
    EXPECT_TRUE(wall["bottlenecks"].empty());
    EXPECT_EQ(wall["latencies"]["capture_to_display"]["clocks"], "synchronised");
    EXPECT_EQ(wall["latencies"]["capture_to_display"]["clock_error_ms"], 1.5);
    EXPECT_EQ(json["streams"][0]["losses"]["incomplete_pairs"]["total"], 7);
    // a program without any report has the same keys
    Report little;
    little.programs = {ProgramReport{}};
    const auto empty = nlohmann::json::parse(render_json(little))["programs"][0];
    for (const auto& [key, value] : alice.items()) EXPECT_TRUE(empty.contains(key)) << key;
}

TEST(RenderJson, OmitsTheErrorOfUntrustedLatencies) {
    const auto json = nlohmann::json::parse(render_json(whole_report(ClockTrust::kUnsynchronised)));
    const auto& latency = json["programs"][1]["latencies"]["capture_to_display"];
    EXPECT_EQ(latency["clocks"], "unsynchronised");
    EXPECT_TRUE(latency["clock_error_ms"].is_null());
}

TEST(RenderJson, ReplacesInvalidUtf8) {
    Report report = whole_report();
    report.programs[0].name = "\xff\xfe\033\n";
    const std::string line = render_json(report);
    EXPECT_TRUE(nlohmann::json::accept(line));
    for (const char c : line) EXPECT_TRUE(c >= ' ' && c <= '~');
}

}  // namespace
}  // namespace atrium::monitor
