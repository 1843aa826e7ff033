#include "tools/demo/demo.hpp"

#include "core/app/process.hpp"
#include "core/bus/bus.hpp"
#include "tools/demo/child_process.hpp"
#include "tools/demo/status_board.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <mutex>
#include <sstream>

namespace atrium::demo {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kStopPatience{
    15};  // the viewer writes its picture and finishes its video

std::vector<std::string> split(const std::string& list) {
    std::vector<std::string> parts;
    std::istringstream stream(list);
    for (std::string part; std::getline(stream, part, ',');) {
        if (!part.empty()) parts.push_back(part);
    }
    return parts;
}

// The demo returns the exit code of the program that failed: docs/conventions.md, "Configuration".
ErrorKind kind_of_exit(int code) {
    if (code == 2) return ErrorKind::kConfiguration;
    if (code == 3) return ErrorKind::kUnavailable;
    return ErrorKind::kInternal;
}

std::string how_it_ended(int code) {
    if (code <= 128) return fmt::format("ended with exit code {}", code);
    return fmt::format("was killed by signal {} ({})", code - 128, strsignal(code - 128));
}

/// Refreshes its lines in place on a terminal; elsewhere prints them one below the other.
class Display {
public:
    void show(const std::vector<std::string>& lines) {
        if (in_place_ && num_shown_ > 0) fmt::print("\033[{}F\033[J", num_shown_);
        // a wrapped line would take two rows and misplace the next refresh
        winsize size{};
        const bool known =
            in_place_ && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
        const std::size_t width = known ? size.ws_col - 1u : std::string::npos;
        for (const std::string& line : lines) fmt::print("{}\n", line.substr(0, width));
        std::fflush(stdout);
        num_shown_ = lines.size();
    }

private:
    bool in_place_ = isatty(STDOUT_FILENO) != 0;
    std::size_t num_shown_ = 0;
};

class Demo {
public:
    Demo(const DemoConfig& config,
         StatusBoard board,
         bus::Waiter waiter,
         bus::Writer<bus::SceneCommand> commands,
         std::string world)
        : config_(config),
          board_(std::move(board)),
          waiter_(std::move(waiter)),
          commands_(std::move(commands)),
          world_(std::move(world)) {}

    Expected<void> start_programs();
    Expected<void> wait_until_everybody_is_on(std::stop_token stop);
    Expected<void> measure(std::stop_token stop);
    Expected<void> stop_programs();

private:
    Expected<void> start(const std::string& name,
                         const std::string& program,
                         int nice,
                         std::vector<std::string> arguments);
    Expected<void> check_children();
    std::map<std::string, std::string> preparing_notes() const;
    bool sleep(std::stop_token stop, Clock::time_point until);

    const DemoConfig& config_;
    StatusBoard board_;
    bus::Waiter waiter_;
    bus::Writer<bus::SceneCommand> commands_;
    std::string world_;
    Display display_;
    std::vector<ChildProcess> children_;
    Clock::time_point started_ = Clock::now();
    double startup_seconds_ = 0.0;  // until everybody was on
    double measured_seconds_ = 0.0;
};

Expected<void> Demo::start(const std::string& name,
                           const std::string& program,
                           int nice,
                           std::vector<std::string> arguments) {
    std::vector<std::string> command{(config_.programs / program).string()};
    command.insert(command.end(), arguments.begin(), arguments.end());
    command.insert(command.end(),
                   {"--bus.world",
                    world_,
                    "--bus.domain",
                    std::to_string(config_.domain),
                    "--process.nice",
                    std::to_string(nice)});
    auto child = ChildProcess::start(name, command, config_.output / (name + ".log"));
    if (!child) return tl::unexpected(child.error());
    children_.push_back(std::move(*child));
    return {};
}

Expected<void> Demo::start_programs() {
    const bool has_display =
        std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr;
    const bool window = config_.window == "yes" || (config_.window == "auto" && has_display);
    auto started =
        start("world", "world_server", config_.world_nice, {"--config", config_.world.string()});
    if (!started) return started;
    const std::vector<std::string> sites = split(config_.sites);
    const std::vector<std::string> motions = split(config_.motions);
    for (std::size_t i = 0; i < sites.size(); ++i) {
        const fs::path file = config_.deploy / "sites" / (sites[i] + ".toml");
        std::vector<std::string> arguments{"--config", file.string()};
        if (!motions.empty())
            arguments.insert(arguments.end(), {"--simulation.motion", motions[i]});
        if (auto site_started = start(sites[i], "site_node", config_.site_nice, arguments);
            !site_started)
            return site_started;
    }
    std::vector<std::string> arguments{"--config",
                                       config_.viewer.string(),
                                       "--output",
                                       (config_.output / "view.png").string(),
                                       "--video.file",
                                       (config_.output / "view.avi").string()};
    if (!config_.camera.empty())
        arguments.insert(arguments.end(), {"--view.position_m", config_.camera});
    if (!config_.target.empty())
        arguments.insert(arguments.end(), {"--view.target_m", config_.target});
    if (config_.fov_deg > 0.0)
        arguments.insert(arguments.end(), {"--view.fov_deg", fmt::format("{}", config_.fov_deg)});
    // the video begins when everybody is on; the demo itself applies the time limit
    arguments.insert(
        arguments.end(),
        {"--wait_people", std::to_string(sites.size()), "--wait_timeout_s", "1000000000"});
    if (!window) arguments.push_back("--headless");
    // fails with a message if there is no display
    if (config_.window == "yes") arguments.insert(arguments.end(), {"--view.context", "window"});
    return start("viewer", "viewer", config_.viewer_nice, arguments);
}

Expected<void> Demo::check_children() {
    for (ChildProcess& child : children_) {
        if (const auto code = child.exit_code()) {
            return make_error(kind_of_exit(*code),
                              fmt::format("{} {}; last line of {}: {}",
                                          child.name(),
                                          how_it_ended(*code),
                                          child.log_file().string(),
                                          child.last_log_line()));
        }
    }
    return {};
}

std::map<std::string, std::string> Demo::preparing_notes() const {
    std::map<std::string, std::string> notes;
    for (const ChildProcess& child : children_) {
        const bool on = child.name() == "world"    ? board_.has_world()
                        : child.name() == "viewer" ? board_.num_pairs_shown() > 0
                                                   : board_.site_publishes(child.name());
        if (on) continue;
        std::string line = child.last_log_line();
        // skip "time level program "
        for (int i = 0; i < 3; ++i) line = line.substr(std::min(line.size(), line.find(' ') + 1));
        notes[child.name()] = "preparing: " + line.substr(0, 68);
    }
    return notes;
}

// Takes status messages until `until`. Returns false once a stop is requested.
bool Demo::sleep(std::stop_token stop, Clock::time_point until) {
    const std::stop_callback wake(stop, [this] { waiter_.wake(); });
    while (!stop.stop_requested()) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
        if (left.count() <= 0) return true;
        waiter_.wait(left);
        board_.update();
    }
    return false;
}

Expected<void> Demo::wait_until_everybody_is_on(std::stop_token stop) {
    const auto begin = Clock::now();
    while (!stop.stop_requested()) {
        if (auto alive = check_children(); !alive) return alive;
        const auto notes = preparing_notes();
        display_.show(board_.table(notes));
        if (notes.empty()) return {};
        if (std::chrono::duration<double>(Clock::now() - begin).count() > config_.startup_seconds) {
            return make_error(ErrorKind::kUnavailable,
                              fmt::format("not everybody is on after {} s: {}: {}",
                                          config_.startup_seconds,
                                          notes.begin()->first,
                                          notes.begin()->second));
        }
        sleep(stop, Clock::now() + std::chrono::seconds(1));
    }
    return {};
}

Expected<void> Demo::measure(std::stop_token stop) {
    board_.begin_report();
    const auto begin = Clock::now();
    startup_seconds_ = std::chrono::duration<double>(begin - started_).count();
    double next_reset_s = 0.0;
    for (int second = 1;; ++second) {
        if (config_.reset_seconds > 0 && measured_seconds_ >= next_reset_s) {
            next_reset_s += config_.reset_seconds;
            bus::SceneCommand reset;
            reset.sender = "demo";
            reset.kind = bus::CommandKind::kReset;
            if (auto sent = commands_.write(reset); !sent) return tl::unexpected(sent.error());
        }
        const bool go_on = sleep(stop, begin + std::chrono::seconds(second));
        measured_seconds_ = std::chrono::duration<double>(Clock::now() - begin).count();
        if (auto alive = check_children(); !alive) return alive;
        const std::string length =
            config_.seconds > 0 ? fmt::format(" of {:.0f} s", config_.seconds) : " s, Ctrl-C ends";
        display_.show(board_.table({{"time", fmt::format("{:.0f}{}", measured_seconds_, length)}}));
        if (!go_on || (config_.seconds > 0 && measured_seconds_ >= config_.seconds)) return {};
    }
}

Expected<void> Demo::stop_programs() {
    // the viewer first, while there is still something to see
    Expected<void> result;
    while (!children_.empty()) {
        const int code = children_.back().stop(kStopPatience);
        if (code != 0 && result) {
            result = make_error(ErrorKind::kInternal,
                                fmt::format("{} {}, see {}",
                                            children_.back().name(),
                                            how_it_ended(code),
                                            children_.back().log_file().string()));
        }
        children_.pop_back();
    }
    if (!result || measured_seconds_ <= 0.0) return result;
    const fs::path report = config_.output / "report.json";
    std::ofstream(report) << board_.report({measured_seconds_, startup_seconds_});
    for (const char* file : {"view.png", "view.avi", "report.json"}) {
        const fs::path path = config_.output / file;
        if (!fs::exists(path) || fs::file_size(path) == 0) {
            return make_error(ErrorKind::kInternal,
                              fmt::format("{} was not written", path.string()));
        }
    }
    fmt::print("picture: {}\nvideo:   {}\nfigures: {}\n",
               (config_.output / "view.png").string(),
               (config_.output / "view.avi").string(),
               report.string());
    return {};
}

}  // namespace

void declare(DemoConfig& config, config::OptionSet& options) {
    options.add(
        "seconds", config.seconds, "length of the measured part [s]; 0: until Ctrl-C", {0, 1e6});
    options.add("startup-seconds",
                config.startup_seconds,
                "time limit until everybody is on [s]",
                {1, 1e5});
    options.add("reset-seconds",
                config.reset_seconds,
                "period of resetting the world's objects [s]; 0: never",
                {0, 1e6});
    options.add("window", config.window, "open a window", {"auto", "yes", "no"});
    options.add("output", config.output, "folder for picture, video, report and logs");
    options.add("programs",
                config.programs,
                "folder of site_node, world_server and viewer; empty: folder of this program");
    options.add("deploy", config.deploy, "folder that holds sites/NAME.toml");
    options.add("sites", config.sites, "names of the sites, separated by commas");
    options.add("motions",
                config.motions,
                "motions of the people at the sites, in the same order, separated by commas "
                "(simulation.motion of site_node); empty: from the site files");
    options.add("world", config.world, "world description");
    options.add("viewer", config.viewer, "viewer configuration");
    options.add("camera",
                config.camera,
                "position of the viewer's eye, \"x,y,z\" in the world [m]; empty: from its file");
    options.add("target",
                config.target,
                "point that the eye looks at, \"x,y,z\" in the world [m]; empty: from its file");
    options.add("fov-deg",
                config.fov_deg,
                "vertical angle of view [deg]; 0: from the viewer file",
                {0, 120});
    options.add("site-nice",
                config.site_nice,
                "process.nice of the sites: -20 highest priority, 19 lowest",
                {-20, 19});
    options.add("world-nice", config.world_nice, "process.nice of the world server", {-20, 19});
    options.add("viewer-nice", config.viewer_nice, "process.nice of the viewer", {-20, 19});
    options.add("domain", config.domain, "DDS domain", {0, 230});
}

Expected<void> run_demo(const DemoConfig& given, std::stop_token stop) {
    DemoConfig config = given;
    if (config.programs.empty()) config.programs = app::program_folder();
    if (split(config.sites).empty()) {
        return make_error(ErrorKind::kConfiguration,
                          "sites: name at least one, for example alice,bob");
    }
    for (const std::string& site : split(config.sites)) {
        if (site.find('/') == std::string::npos && !site.ends_with(".toml")) continue;
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("sites: give names of files in {}, such as alice, not paths; got '{}'",
                        (config.deploy / "sites").string(),
                        site));
    }
    if (const std::size_t num_motions = split(config.motions).size();
        num_motions != 0 && num_motions != split(config.sites).size()) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("motions: give one for each of the {} sites, or none; got {}",
                                      split(config.sites).size(),
                                      num_motions));
    }
    std::error_code failure;
    fs::create_directories(config.output, failure);
    if (!fs::is_directory(config.output)) {
        return make_error(
            ErrorKind::kUnavailable,
            fmt::format("output: cannot create the folder '{}'", config.output.string()));
    }
    for (const char* file : {"view.png", "view.avi", "report.json"})
        fs::remove(config.output / file, failure);

    // a unique world, so two demos on one host do not meet
    const std::string world = fmt::format("demo-{}", getpid());
    bus::BusOptions options;
    options.world = world;
    options.domain = static_cast<std::uint32_t>(config.domain);
    auto participant = bus::Participant::create(options);
    if (!participant) return tl::unexpected(participant.error());
    auto board = StatusBoard::create(*participant);
    if (!board) return tl::unexpected(board.error());
    auto waiter = bus::Waiter::create(*participant);
    if (!waiter) return tl::unexpected(waiter.error());
    board->attach(*waiter);
    auto commands = bus::Writer<bus::SceneCommand>::create(*participant);
    if (!commands) return tl::unexpected(commands.error());

    Demo demo(config, std::move(*board), std::move(*waiter), std::move(*commands), world);
    Expected<void> result = demo.start_programs();
    if (result) result = demo.wait_until_everybody_is_on(stop);
    if (result && !stop.stop_requested()) result = demo.measure(stop);
    const Expected<void> stopped = demo.stop_programs();
    return result ? stopped : result;
}

}  // namespace atrium::demo
