#include "tools/demo/demo.hpp"

#include "core/app/process.hpp"
#include "core/bus/bus.hpp"
#include "core/bus/limits.hpp"
#include "tools/demo/child_process.hpp"
#include "tools/demo/display.hpp"
#include "tools/demo/log_lines.hpp"
#include "tools/demo/result_folder.hpp"
#include "tools/demo/start_checks.hpp"
#include "tools/demo/status_board.hpp"
#include "tools/demo/throwaway_keys.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>

namespace atrium::demo {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kStopPatience{
    15};  // the viewer writes its picture and finishes its video

constexpr const char* kLegend =
    "rate: results per second. ms since capture: until published, in the physics (touched), on the "
    "display.\n"
    "dropped: incomplete, too late, left out for a viewer's link, failed. cores: in use. wait: "
    "time "
    "without a free core.";

// The demo returns the exit code of the program that failed: docs/conventions.md, "Configuration".
ErrorKind kind_of_exit(int code) {
    if (code == 2) return ErrorKind::kConfiguration;
    if (code == 3) return ErrorKind::kUnavailable;
    return ErrorKind::kInternal;
}

std::string how_it_ended(int code) {
    if (code <= 128) return fmt::format("ended with exit code {}", code);
    const int number = code - 128;
    const char* name = sigabbrev_np(number);
    const std::string text =
        fmt::format("ended by signal {} (SIG{})", number, name != nullptr ? name : "?");
    if (number != SIGKILL) return text;
    return text + ": somebody killed it, or the kernel because memory ran out (see dmesg)";
}

class Demo {
public:
    Demo(const DemoConfig& config,
         StatusBoard board,
         bus::Waiter waiter,
         bus::Writer<bus::SceneCommand> commands,
         std::vector<DemoSite> sites,
         const ResultFolder& folder,
         std::string world,
         const ThrowawayKeys* keys)
        : config_(config),
          sites_(std::move(sites)),
          folder_(folder),
          board_(std::move(board)),
          waiter_(std::move(waiter)),
          commands_(std::move(commands)),
          world_(std::move(world)),
          keys_(keys) {}

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
    std::string describe_failure(const ChildProcess& child, const std::string& what) const;
    std::string preparing_note(const ChildProcess& child) const;
    std::map<std::string, std::string> preparing_notes() const;
    void print_doubts() const;
    bool sleep(std::stop_token stop, Clock::time_point until);

    const DemoConfig& config_;
    std::vector<DemoSite> sites_;
    const ResultFolder& folder_;
    StatusBoard board_;
    bus::Waiter waiter_;
    bus::Writer<bus::SceneCommand> commands_;
    std::string world_;
    const ThrowawayKeys* keys_;  // null: without keys
    Display display_{std::chrono::ceil<Display::Clock::duration>(
        std::chrono::duration<double>(config_.table_seconds))};
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
                    std::to_string(nice),
                    "--bus.security",
                    keys_ == nullptr ? "none" : keys_->bundle_of(name).string()});
    auto child = ChildProcess::start(name, command, folder_.running() / (name + ".log"));
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
    for (const DemoSite& site : sites_) {
        std::vector<std::string> arguments{"--config", site.file.string()};
        if (!site.motion.empty())
            arguments.insert(arguments.end(), {"--simulation.motion", site.motion});
        if (auto site_started = start(site.name, "site_node", config_.site_nice, arguments);
            !site_started)
            return site_started;
    }
    std::vector<std::string> arguments{"--config",
                                       config_.viewer.string(),
                                       "--output",
                                       (folder_.running() / "view.png").string(),
                                       "--video.file",
                                       (folder_.running() / "view.avi").string()};
    if (const fs::path models = models_for_viewer(config_); !models.empty())
        arguments.insert(arguments.end(), {"--viewer.models", models.string()});
    if (!config_.camera.empty())
        arguments.insert(arguments.end(), {"--view.position_m", config_.camera});
    if (!config_.target.empty())
        arguments.insert(arguments.end(), {"--view.target_m", config_.target});
    if (config_.fov_deg > 0.0)
        arguments.insert(arguments.end(), {"--view.fov_deg", fmt::format("{}", config_.fov_deg)});
    // the video begins when everybody is on; the demo itself applies the time limit
    arguments.insert(
        arguments.end(),
        {"--wait_people", std::to_string(sites_.size()), "--wait_timeout_s", "1000000000"});
    if (!window) arguments.push_back("--headless");
    // fails with a message if there is no display
    if (config_.window == "yes") arguments.insert(arguments.end(), {"--view.context", "window"});
    return start("viewer", "viewer", config_.viewer_nice, arguments);
}

// Adds the last error or warning of the child's log to what happened.
std::string Demo::describe_failure(const ChildProcess& child, const std::string& what) const {
    // the warnings of a program that was killed are not the reason
    const bool with_warnings = what.find("signal") == std::string::npos;
    const std::string problem = last_problem(child.log_tail(), with_warnings);
    return fmt::format("{} {}{}; its log: {}",
                       child.name(),
                       what,
                       problem.empty() ? "" : fmt::format("; it said: {}", problem),
                       (folder_.failed() / child.log_file().filename()).string());
}

Expected<void> Demo::check_children() {
    for (ChildProcess& child : children_) {
        if (const auto code = child.exit_code())
            return make_error(kind_of_exit(*code), describe_failure(child, how_it_ended(*code)));
    }
    return {};
}

std::string Demo::preparing_note(const ChildProcess& child) const {
    if (const auto percent = rendering_percent(child.log_tail()))
        return fmt::format("rendering {}'s room (first start only), {} %", child.name(), *percent);
    return child.name() == "viewer" && board_.has_viewer() ? "waiting for people" : "starting";
}

std::map<std::string, std::string> Demo::preparing_notes() const {
    std::map<std::string, std::string> notes;
    for (const ChildProcess& child : children_) {
        const bool on = child.name() == "world"    ? board_.has_world()
                        : child.name() == "viewer" ? board_.num_pairs_shown() > 0
                                                   : board_.site_publishes(child.name());
        if (!on) notes[child.name()] = "preparing: " + preparing_note(child);
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
            const auto late = std::ranges::find(
                children_, notes.begin()->first, [](const auto& child) { return child.name(); });
            return make_error(
                ErrorKind::kUnavailable,
                describe_failure(*late,
                                 fmt::format("is not on after {} s (startup-seconds), {}",
                                             config_.startup_seconds,
                                             notes.begin()->second)));
        }
        sleep(stop, Clock::now() + std::chrono::seconds(1));
    }
    return {};
}

// What the programs found odd in the world's files, which the user would look for in the logs.
void Demo::print_doubts() const {
    constexpr std::size_t kMost = 8;
    for (const ChildProcess& child : children_) {
        const std::vector<std::string> lines = doubts(child.log_tail());
        for (std::size_t i = 0; i < std::min(kMost, lines.size()); ++i)
            fmt::print("{}: {}\n", child.name(), lines[i]);
        if (lines.size() > kMost)
            fmt::print("{}: {} more in {}\n",
                       child.name(),
                       lines.size() - kMost,
                       child.log_file().string());
    }
}

Expected<void> Demo::measure(std::stop_token stop) {
    board_.begin_report();
    display_.leave();
    print_doubts();
    fmt::print("{}\n", kLegend);
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
        const bool is_last =
            !go_on || (config_.seconds > 0 && measured_seconds_ >= config_.seconds);
        display_.show(board_.table({{"time", fmt::format("{:.0f}{}", measured_seconds_, length)}}),
                      is_last);
        if (is_last) return {};
    }
}

Expected<void> Demo::stop_programs() {
    // the viewer first, while there is still something to see
    Expected<void> result;
    while (!children_.empty()) {
        const int code = children_.back().stop(kStopPatience);
        if (code != 0 && result) {
            result = make_error(ErrorKind::kInternal,
                                describe_failure(children_.back(), how_it_ended(code)));
        }
        children_.pop_back();
    }
    if (!result || measured_seconds_ <= 0.0) return result;
    std::ofstream(folder_.running() / "report.json")
        << board_.report({measured_seconds_, startup_seconds_});
    for (const char* file : {"view.png", "view.avi", "report.json"}) {
        const fs::path path = folder_.running() / file;
        std::error_code missing;
        if (const auto size = fs::file_size(path, missing); missing || size == 0) {
            return make_error(ErrorKind::kInternal,
                              fmt::format("{} was not written; is the disk full?", path.string()));
        }
    }
    if (auto kept = folder_.keep(); !kept) return kept;
    fmt::print("picture: {}\nvideo:   {}\nfigures: {}\n",
               (config_.output / "view.png").string(),
               (config_.output / "view.avi").string(),
               (config_.output / "report.json").string());
    return {};
}

}  // namespace

Expected<void> run_demo(const DemoConfig& given, std::stop_token stop) {
    DemoConfig config = given;
    use_installed(config, app::program_folder());
    auto sites = check_start(config);
    if (!sites) return tl::unexpected(sites.error());
    const auto folder = ResultFolder::create(config.output);
    if (!folder) return tl::unexpected(folder.error());

    // a unique world, so two demos on one host do not meet
    const std::string world = fmt::format("demo-{}", getpid());
    bus::BusOptions options;
    options.world = world;
    options.security = "none";
    std::optional<ThrowawayKeys> keys;
    if (config.secured) {
        auto made = ThrowawayKeys::create(folder->running() / "keys", world, *sites);
        if (!made) return tl::unexpected(made.error());
        keys.emplace(std::move(*made));
        options.security = keys->bundle_of("demo").string();
        fmt::print("keys: made for this run; everything is encrypted\n");
    }
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

    Demo demo(config,
              std::move(*board),
              std::move(*waiter),
              std::move(*commands),
              std::move(*sites),
              *folder,
              world,
              keys ? &*keys : nullptr);
    Expected<void> result = demo.start_programs();
    if (result) result = demo.wait_until_everybody_is_on(stop);
    if (result && !stop.stop_requested()) result = demo.measure(stop);
    const Expected<void> stopped = demo.stop_programs();
    if (result) result = stopped;
    folder->set_aside();  // does nothing after success
    return result;
}

}  // namespace atrium::demo
