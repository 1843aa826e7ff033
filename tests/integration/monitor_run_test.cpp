#include "core/bus/bus.hpp"
#include "core/presence/membership.hpp"
#include "tests/support/run_program.hpp"
#include "tools/monitor/inbox.hpp"
#include "tools/monitor/screen.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <sstream>
#include <thread>

// A world of programs that only report their status, and a monitor that listens to them.
namespace atrium {
namespace {

using namespace std::chrono_literals;
using bus::ProgramKind;
using test_support::Outcome;
using testing::HasSubstr;
using testing::SizeIs;

constexpr const char* kWorld = "monitor-test";
constexpr int kDomain = 176;  // used by this test only

bus::BusOptions bus_options() {
    bus::BusOptions options;
    options.world = kWorld;
    options.domain = kDomain;
    return options;
}

template <typename Message>
bus::Writer<Message> writer(const bus::Participant& participant) {
    auto made = bus::Writer<Message>::create(participant);
    EXPECT_TRUE(made) << made.error().message;
    return std::move(*made);
}

/// A program's presence in the world. It sends its status ten times a second.
class Speaker {
public:
    Speaker(ProgramKind kind,
            const std::string& name,
            const std::function<std::function<void(int)>(const bus::Participant&)>& make_say) {
        auto participant = bus::Participant::create(bus_options());
        EXPECT_TRUE(participant) << participant.error().message;
        const auto quiet = [](const std::string&) {};
        auto member = presence::Membership::join(
            *participant, {kind, name, "1.2.3"}, {quiet, quiet, [](const Error&) {}});
        EXPECT_TRUE(member) << member.error().message;
        membership_ = std::move(*member);
        thread_ = std::jthread([say = make_say(*participant)](std::stop_token stop) {
            std::mutex mutex;
            std::condition_variable_any pace;
            std::unique_lock lock(mutex);
            for (int i = 0; !stop.stop_requested(); ++i) {
                say(i);
                pace.wait_for(lock, stop, 100ms, [] { return false; });
            }
        });
    }

private:
    std::unique_ptr<presence::Membership> membership_;
    std::jthread thread_;  // destroyed first
};

std::function<void(int)> speak_as_site(const bus::Participant& participant) {
    return [statuses = writer<bus::SiteStatus>(participant),
            meshes = writer<bus::SiteMesh>(participant)](int i) mutable {
        bus::SiteStatus status;
        status.site = "lab";
        status.time = Timestamp::now();
        status.metaframes_per_s = 30.0;
        status.num_dropped_late = static_cast<std::uint64_t>(i);
        status.stages = {4.0, 3.0, 2.0, 1.0};
        status.mesh_bytes_per_s = 5000.0;
        status.texture_bytes_per_s = 70'000.0;
        bus::CameraStatus camera;
        camera.name = "cam0";
        camera.num_incomplete = 3;
        status.cameras = {camera};
        EXPECT_TRUE(statuses.write(status));
        bus::SiteMesh mesh;
        mesh.site = "lab";
        mesh.frame_id = static_cast<std::uint64_t>(i);
        mesh.draco.assign(1000, 7);
        EXPECT_TRUE(meshes.write(mesh));
    };
}

std::function<void(int)> speak_as_world(const bus::Participant& participant) {
    return [statuses = writer<bus::WorldStatus>(participant)](int i) mutable {
        bus::WorldStatus status;
        status.world = kWorld;
        status.time = Timestamp::now();
        status.steps_per_s = 120.0;
        status.num_steps = static_cast<std::uint64_t>(i);
        EXPECT_TRUE(statuses.write(status));
    };
}

std::function<void(int)> speak_as_viewer(const bus::Participant& participant) {
    return [statuses = writer<bus::ViewerStatus>(participant),
            feedback = writer<bus::StreamFeedback>(participant)](int i) mutable {
        bus::ViewerStatus status;
        status.viewer = "wall";
        status.time = Timestamp::now();
        status.num_frames = static_cast<std::uint64_t>(i);
        status.frames_per_s = 60.0;
        status.capture_to_display = {51.0, 60.0, 100};
        EXPECT_TRUE(statuses.write(status));
        bus::StreamFeedback sample;
        sample.viewer = "wall";
        sample.site = "lab";
        sample.num_complete = 3;
        sample.num_incomplete = 1;
        EXPECT_TRUE(feedback.write(sample));
    };
}

Outcome run_monitor(const std::string& arguments, const std::string& world = kWorld) {
    return test_support::run_program(ATRIUM_BIN_DIR "/monitor --bus.world " + world +
                                         " --bus.domain " + std::to_string(kDomain) + " " +
                                         arguments,
                                     60);
}

std::vector<nlohmann::json> objects_in(const std::string& output) {
    std::vector<nlohmann::json> objects;
    std::istringstream lines(output);
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with("{")) continue;  // the log
        EXPECT_TRUE(nlohmann::json::accept(line)) << line;
        objects.push_back(nlohmann::json::parse(line, nullptr, false));
    }
    return objects;
}

TEST(MonitorRun, JsonReportListsThePrograms) {
    const Speaker site(ProgramKind::kSiteNode, "lab", speak_as_site);
    const Speaker world(ProgramKind::kWorldServer, kWorld, speak_as_world);
    const Speaker viewer(ProgramKind::kViewer, "wall", speak_as_viewer);
    const Outcome outcome = run_monitor("--json --once --wait 4");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    const auto objects = objects_in(outcome.output);
    ASSERT_THAT(objects, SizeIs(1)) << outcome.output;
    const nlohmann::json& report = objects[0];
    EXPECT_EQ(report["num_here"], 3) << report.dump(1);
    ASSERT_THAT(report["programs"], SizeIs(3));
    const auto& lab = report["programs"][0];
    EXPECT_EQ(lab["kind"], "site");
    EXPECT_EQ(lab["host"], presence::host_name());
    EXPECT_EQ(lab["pid"], getpid());
    EXPECT_EQ(lab["rate"], 30.0);
    EXPECT_EQ(lab["latencies"]["coding"]["median_ms"], 2.0);
    EXPECT_EQ(lab["topics"]["SiteMesh"]["bytes_per_s"], 5000.0);
    EXPECT_EQ(lab["topics"]["SiteMesh"]["source"], "reported");
    EXPECT_NEAR(lab["losses"]["dropped_late"]["per_s"].get<double>(), 10.0, 9.0);
    EXPECT_EQ(lab["cameras"][0]["losses"]["incomplete"]["total"], 3);
    EXPECT_EQ(report["programs"][1]["kind"], "world_server");
    EXPECT_EQ(report["programs"][1]["rate"], 120.0);
    EXPECT_EQ(report["programs"][2]["name"], "wall");
    EXPECT_EQ(report["programs"][2]["latencies"]["capture_to_display"]["clocks"], "one_clock");
    ASSERT_THAT(report["streams"], SizeIs(1));
    EXPECT_GT(report["streams"][0]["losses"]["incomplete_pairs"]["total"], 5);

    const Outcome text = run_monitor("--once --wait 4 --site lab");
    EXPECT_EQ(text.exit_code, 0) << text.output;
    for (const char* part : {"site lab", "world server monitor-test", "viewer wall", "cam0"})
        EXPECT_THAT(text.output, HasSubstr(part));
    EXPECT_THAT(text.output, testing::Not(HasSubstr("\033"))) << "this is no terminal";

    const Outcome measured = run_monitor("--json --measure --seconds 4.5");
    EXPECT_EQ(measured.exit_code, 0) << measured.output;
    const auto seconds = objects_in(measured.output);
    ASSERT_GE(seconds.size(), 4u);
    const auto& mesh = seconds.back()["programs"][0]["topics"]["SiteMesh"];
    EXPECT_EQ(mesh["source"], "measured");
    EXPECT_GT(mesh["bytes_per_s"], 1000.0);
    EXPECT_LT(mesh["bytes_per_s"], 20'000.0);
}

TEST(MonitorRun, EmptyWorldExitsWithThree) {
    const Outcome outcome = run_monitor("--json --once --wait 0.5", "empty-world");
    EXPECT_EQ(outcome.exit_code, 3);
    EXPECT_THAT(outcome.output, HasSubstr("nobody is there: world=empty-world"));
    ASSERT_THAT(objects_in(outcome.output), SizeIs(1));
    EXPECT_EQ(objects_in(outcome.output)[0]["num_here"], 0);
}

/// Output of a monitor on a terminal of 90 x 30, until it ends. The test types Ctrl-C after its
/// first drawing.
Outcome type_ctrl_c_at_a_monitor() {
    winsize size{};
    size.ws_col = 90;
    size.ws_row = 30;
    int terminal = -1;
    const pid_t child = forkpty(&terminal, nullptr, nullptr, &size);
    if (child == 0) {
        setenv("TERM", "xterm", 1);
        unsetenv("NO_COLOR");
        const std::string domain = std::to_string(kDomain);
        execl(ATRIUM_BIN_DIR "/monitor",
              "monitor",
              "--bus.domain",
              domain.c_str(),
              "--seconds",
              "50",
              nullptr);
        _exit(127);
    }
    Outcome outcome;
    std::array<char, 4096> buffer;
    bool has_typed = false;
    for (ssize_t n = 0; (n = read(terminal, buffer.data(), buffer.size())) > 0;) {
        outcome.output.append(buffer.data(), static_cast<std::size_t>(n));
        if (has_typed || outcome.output.find("nobody is there") == std::string::npos) continue;
        has_typed = write(terminal, "\x03", 1) == 1;
    }
    close(terminal);
    int status = 0;
    waitpid(child, &status, 0);
    outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
    return outcome;
}

TEST(MonitorRun, DrawsInPlaceAndRestoresTheTerminal) {
    const auto begin = std::chrono::steady_clock::now();
    const Outcome outcome = type_ctrl_c_at_a_monitor();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 40s) << "Ctrl-C must end the monitor";
    const std::string own_screen = "\033[?1049h\033[?25l";
    const std::string as_it_was = "\033[?25h\033[?1049l";
    EXPECT_EQ(outcome.output.find(own_screen), 0u);
    const std::size_t end = outcome.output.rfind(as_it_was);
    ASSERT_NE(end, std::string::npos);
    EXPECT_THAT(outcome.output.substr(0, end), HasSubstr("\033[H"));
    EXPECT_THAT(outcome.output.substr(0, end), HasSubstr("\033[33mnobody is there"));
    EXPECT_THAT(outcome.output.substr(end), HasSubstr("nobody is there"))
        << "the last report must stay on the screen";
}

// The second Ctrl-C ends a program without destructors (core/app).
TEST(MonitorRun, SecondCtrlCRestoresTheTerminal) {
    int terminal = -1;
    const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
    if (child == 0) {
        const monitor::Screen screen(true);
        std::quick_exit(130);
    }
    std::string output;
    std::array<char, 256> buffer;
    for (ssize_t n = 0; (n = read(terminal, buffer.data(), buffer.size())) > 0;) {
        output.append(buffer.data(), static_cast<std::size_t>(n));
    }
    close(terminal);
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 130);
    EXPECT_EQ(output, "\033[?1049h\033[?25l\033[0m\033[?25h\033[?1049l");
}

TEST(MonitorRun, ReportsAnEndWithItsReasonAndStaysInvisible) {
    auto inbox = monitor::Inbox::create(bus_options(), /*measure=*/false);
    ASSERT_TRUE(inbox) << inbox.error().message;
    monitor::WorldModel model(kWorld);
    const auto await = [&](const std::function<bool(const monitor::Report&)>& done) {
        const auto give_up = std::chrono::steady_clock::now() + 30s;
        while (std::chrono::steady_clock::now() < give_up) {
            inbox->wait(100ms);
            inbox->take(model);
            if (done(model.report(monitor::WorldModel::Clock::now(), Timestamp::now())))
                return true;
        }
        return false;
    };
    auto participant = bus::Participant::create(bus_options());
    ASSERT_TRUE(participant) << participant.error().message;
    const auto meshes = writer<bus::SiteMesh>(*participant);
    {
        const Speaker world(ProgramKind::kWorldServer, kWorld, speak_as_world);
        EXPECT_TRUE(await([](const monitor::Report& report) {
            return report.num_here() == 1 && report.programs[0].has_status &&
                   report.programs[0].is_known;
        }));
    }
    std::string reason;
    EXPECT_TRUE(await([&](const monitor::Report& report) {
        if (report.num_here() > 0 || report.programs.empty()) return false;
        reason = report.programs[0].gone_reason;
        return true;
    }));
    EXPECT_EQ(reason, "it ended");
    EXPECT_EQ(meshes.num_readers(), 0)
        << "the monitor must not read topics that it does not measure";
}

}  // namespace
}  // namespace atrium
