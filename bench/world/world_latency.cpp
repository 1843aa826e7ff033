#include "bench/latency/push_watch.hpp"
#include "bench/scale/own_host.hpp"
#include "bench/usage.hpp"
#include "core/bus/bus.hpp"
#include "tests/support/network/hosted_process.hpp"
#include "tests/support/network/mesh_site.hpp"
#include "tests/support/world/physics_meshes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

// Time from a hand's capture to the published motion of the object that it pushes, all on one host,
// with each site and the world server in its own process. Writes one row of CSV. world_latency.sh
// makes the table of docs/measurements/world.md from it:
//
//   world_latency NAME KIND SITES SECONDS [RATE_HZ]
//
// KIND: a rig.toml, whose cameras see simulated rooms in site_node programs. Or "meshes": people of
// boxes whose meshes are sent 16 ms after their capture, the site's time as measured by
// bench/site/site_8x1mp.sh. `world_latency head` prints the column names.
namespace {

using namespace atrium;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using test::HostedProcess;

constexpr auto kPatience = 180s;          // rooms are rendered
constexpr int kSettled = 60;              // meshes of each site before counting starts
constexpr double kLoopS = 1.5;            // period of the pushes; a hand arrives with about 0.7 m/s
constexpr double kBeyondPeriodMs = 25.0;  // maximum duration of a push
constexpr double kBallM = 0.16;
constexpr auto kSiteWork = 16ms;
const std::string kNetwork = "loopback";

[[noreturn]] void fail(int code, const std::string& why) {
    fmt::print(stderr, "{}\n", why);
    std::exit(code);
}

template <typename T>
T value(Expected<T> expected) {
    if (!expected) fail(1, expected.error().message);
    return std::move(*expected);
}

struct Case {
    std::string name;
    std::string kind;
    std::size_t num_sites = 1;
    std::chrono::seconds length{30};
    double rate_hz = 30.0;  // of the captures

    double bar_ms() const { return 1000.0 / rate_hz + kBeyondPeriodMs; }

    bool has_cameras() const { return kind != "meshes"; }
    /// Place of the ball, in front of a hand about in the middle of its path.
    Eigen::Vector3d ball_site() const {
        return has_cameras() ? Eigen::Vector3d(0.52, -0.20, 1.21)
                             : Eigen::Vector3d(0.70, -0.17, 1.3);
    }
};

// Sites stand on a ring, far enough apart.
geometry::RigidTransform world_from_site(std::size_t site) {
    const double yaw_rad = 0.5 * std::numbers::pi * static_cast<double>(site);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
    return {turn, turn * Eigen::Vector3d(-1.5, 0.0, 0.0)};
}

std::string site_name(std::size_t site) { return fmt::format("site-{}", site); }

std::string world_file(const Case& c) {
    std::string text =
        "[world]\n[[object]]\nname = \"floor\"\nshape = \"plane\"\nsize_m = [8, 8]\n";
    for (std::size_t i = 0; i < c.num_sites; ++i) {
        const geometry::RigidTransform pose = world_from_site(i);
        const double yaw_deg = 90.0 * static_cast<double>(i);
        const Eigen::Vector3d shelf =
            pose * Eigen::Vector3d(c.ball_site() - Eigen::Vector3d(0.0, 0.0, 0.5 * kBallM + 0.02));
        text += fmt::format(
            "[[site]]\nname = \"{}\"\nposition_m = [{:.6f}, {:.6f}, 0.0]\nyaw_deg = {:.1f}\n",
            site_name(i),
            pose.translation.x(),
            pose.translation.y(),
            yaw_deg);
        text += fmt::format(
            "[[object]]\nname = \"shelf-{}\"\nshape = \"box\"\nsize_m = [0.3, 0.3, 0.04]\nmass_kg "
            "= 0\n"
            "position_m = [{:.6f}, {:.6f}, {:.6f}]\nroll_pitch_yaw_deg = [0, 0, {:.1f}]\n",
            i,
            shelf.x(),
            shelf.y(),
            shelf.z(),
            yaw_deg);
    }
    return text;
}

bench::Target target(const Case& c, std::size_t site) {
    bench::Target target;
    target.site = site_name(site);
    target.world_from_site = world_from_site(site);
    target.ball.object = 2000 + static_cast<std::uint32_t>(site);
    target.ball.name = fmt::format("ball-{}", site);
    target.ball.shape = bus::Shape::kSphere;
    target.ball.size_m.setConstant(kBallM);
    target.ball.mass_kg = 0.4;
    target.ball.world_from_object.translation = target.world_from_site * c.ball_site();
    // more than the hand's motion between meshes: it may meet the ball at any moment between them
    target.spread_m =
        (target.world_from_site.rotation * Eigen::Vector3d(0.03, 0.0, 0.0)).cwiseAbs();
    return target;
}

// A person of boxes whose arms move forth and back.
geometry::TriangleMesh person_at(Timestamp capture, std::size_t site) {
    constexpr auto kLoopNs = static_cast<std::int64_t>(1e9 * kLoopS);
    const double phase = static_cast<double>(capture.ns % kLoopNs) / static_cast<double>(kLoopNs);
    const double turns = phase + 0.37 * static_cast<double>(site);
    const double reach_m = 0.50 - 0.17 * std::cos(2.0 * std::numbers::pi * turns);
    return physics_test::make_person_mesh({0.0, 0.0, 0.0}, reach_m, 20);
}

/// The programs of a case, from the first start to the last end.
class Programs {
public:
    Programs(const Case& c, const bus::BusOptions& options) {
        const auto file =
            std::filesystem::temp_directory_path() / fmt::format("world_latency-{}.toml", getpid());
        std::ofstream(file) << world_file(c);
        const std::vector<std::string> bus{"--bus.world", options.world, "--network", kNetwork};
        start(ATRIUM_BIN_DIR "/world_server", {"--config", file.string()}, bus);
        for (std::size_t i = 0; i < c.num_sites; ++i) {
            if (!c.has_cameras()) {
                made_up_.push_back(value(test::MeshSite::start(
                    options,
                    {.name = site_name(i), .rate_hz = c.rate_hz, .work = kSiteWork},
                    [i](Timestamp capture) { return person_at(capture, i); })));
                continue;
            }
            start(ATRIUM_BIN_DIR "/site_node",
                  {"--site.name",
                   site_name(i),
                   "--capture.source",
                   "simulated",
                   "--capture.rig",
                   c.kind,
                   "--capture.rate_hz",
                   fmt::format("{}", c.rate_hz),
                   "--simulation.look",
                   "ada",
                   "--simulation.motion",
                   "push",
                   "--simulation.loop_s",
                   fmt::format("{}", kLoopS)},
                  bus);
        }
        std::this_thread::sleep_for(1s);  // the world server has read its file
        std::filesystem::remove(file);
    }

    void finish() {
        made_up_.clear();
        for (auto process = processes_.rbegin(); process != processes_.rend(); ++process) {
            (*process)->signal(SIGTERM);
            if ((*process)->wait(10s) != 0) fail(1, (*process)->output());
        }
    }

    void check() const {
        for (const auto& process : processes_)
            if (process->wait(0ms)) fail(1, process->output());
    }

private:
    void start(const std::string& program,
               std::vector<std::string> options,
               const std::vector<std::string>& bus) {
        options.insert(options.begin(), program);
        options.insert(options.end(), bus.begin(), bus.end());
        processes_.push_back(value(HostedProcess::start(options)));
    }

    std::vector<std::unique_ptr<HostedProcess>> processes_;
    std::vector<std::unique_ptr<test::MeshSite>> made_up_;
};

/// Watches all hands of a case over the bus.
class Observer {
public:
    Observer(const Case& c, const bus::BusOptions& options)
        : participant_(value(bus::Participant::create(options))),
          meshes_(value(bus::Reader<bus::SiteMesh>::create(participant_))),
          states_(value(bus::Reader<bus::SceneState>::create(participant_))),
          site_statuses_(value(bus::Reader<bus::SiteStatus>::create(participant_))),
          world_statuses_(value(bus::Reader<bus::WorldStatus>::create(participant_))),
          commands_(value(bus::Writer<bus::SceneCommand>::create(participant_))),
          waiter_(value(bus::Waiter::create(participant_))) {
        waiter_.add(meshes_);
        waiter_.add(states_);
        for (std::size_t i = 0; i < c.num_sites; ++i) watches_.emplace_back(target(c, i), 1000 + i);
    }

    /// Waits until all sites send meshes and the world sends states. Returns false at the timeout.
    bool wait_for_all(const Programs& programs) {
        const auto give_up = Clock::now() + kPatience;
        std::map<std::string, int> num_meshes;
        int num_states = 0;
        for (const auto& watch : watches_) num_meshes[watch.site()] = 0;
        const auto has_settled = [](const auto& site) { return site.second >= kSettled; };
        while (num_states == 0 || !std::ranges::all_of(num_meshes, has_settled)) {
            if (Clock::now() > give_up) return false;
            programs.check();
            waiter_.wait(500ms);
            meshes_.take([&](bus::SiteMesh&& mesh) { ++num_meshes[mesh.site]; });
            states_.take([&](bus::SceneState&&) { ++num_states; });
        }
        return true;
    }

    void watch(std::chrono::nanoseconds length) {
        for (const auto end = Clock::now() + length; Clock::now() < end;) {
            waiter_.wait(100ms);
            // states first: they take less time here
            states_.take([&](bus::SceneState&& state) {
                const Timestamp now = Timestamp::now();
                for (auto& watch : watches_) send(watch.see(state, now));
            });
            meshes_.take([&](bus::SiteMesh&& mesh) {
                const Timestamp now = Timestamp::now();
                for (auto& watch : watches_)
                    if (watch.site() == mesh.site) send(watch.see(mesh, now));
            });
        }
        site_statuses_.take([&](bus::SiteStatus&& s) { site_status_ = std::move(s); });
        world_statuses_.take([&](bus::WorldStatus&& s) { world_status_ = std::move(s); });
    }

    const std::vector<bench::PushWatch>& watches() const { return watches_; }
    const bus::SiteStatus& site_status() const { return site_status_; }
    const bus::WorldStatus& world_status() const { return world_status_; }

private:
    void send(const std::optional<bus::SceneCommand>& command) {
        if (command) static_cast<void>(value(commands_.write(*command)));
    }

    bus::Participant participant_;
    bus::Reader<bus::SiteMesh> meshes_;
    bus::Reader<bus::SceneState> states_;
    bus::Reader<bus::SiteStatus> site_statuses_;
    bus::Reader<bus::WorldStatus> world_statuses_;
    bus::Writer<bus::SceneCommand> commands_;
    bus::Waiter waiter_;
    std::vector<bench::PushWatch> watches_;
    bus::SiteStatus site_status_;  // of one of them, the latest
    bus::WorldStatus world_status_;
};

/// Times between two moments of all pushes, sorted.
class Times {
public:
    Times(const std::vector<bench::PushWatch>& watches,
          Timestamp bench::Push::*from,
          Timestamp bench::Push::*to) {
        for (const auto& watch : watches)
            for (const bench::Push& push : watch.pushes())
                ms_.push_back(1e-6 * static_cast<double>((push.*to - push.*from).count()));
        std::sort(ms_.begin(), ms_.end());
    }

    double ms(double share) const {
        if (ms_.empty()) return std::nan("");
        const auto rank = std::ceil(share * static_cast<double>(ms_.size()));
        return ms_[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
    }
    std::size_t num() const { return ms_.size(); }
    double share_within(double limit_ms) const {
        const auto num_within = std::upper_bound(ms_.begin(), ms_.end(), limit_ms) - ms_.begin();
        return static_cast<double>(num_within) / static_cast<double>(ms_.size());
    }

private:
    std::vector<double> ms_;
};

void print(const Case& c, const Observer& observer) {
    using bench::Push;
    const auto& watches = observer.watches();
    const auto median = [&](Timestamp Push::*from, Timestamp Push::*to) {
        return Times(watches, from, to).ms(0.5);
    };
    const Times all(watches, &Push::capture, &Push::state_received);
    std::size_t num_missed = 0;
    for (const auto& watch : watches) num_missed += watch.num_missed();
    fmt::print("\"{}\",{},{},{:.1f},{},{},{:.3f}",
               c.name,
               c.num_sites,
               c.rate_hz,
               c.bar_ms(),
               all.num(),
               num_missed,
               all.share_within(c.bar_ms()));
    for (const double share : {0.5, 0.9, 0.99, 1.0}) fmt::print(",{:.1f}", all.ms(share));
    fmt::print(",{:.1f},{:.1f},{:.1f},{:.1f},{:.1f},{:.1f},{:.1f},{}\n",
               median(&Push::capture, &Push::moved),
               median(&Push::capture, &Push::mesh_received),
               median(&Push::mesh_received, &Push::moved),
               median(&Push::moved, &Push::state_received),
               median(&Push::touch, &Push::state_received),
               observer.site_status().capture_to_publish.median_ms,
               observer.world_status().capture_to_collision.median_ms,
               observer.world_status().num_skipped_ticks);
}

constexpr const char* kUsage =
    "usage: world_latency NAME KIND SITES SECONDS [RATE_HZ]    one row; KIND: a rig.toml, or "
    "meshes\n"
    "       world_latency head                                 the column names\n";

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> words = bench::words_or_usage(argc, argv, {1, 4, 5}, kUsage);
    if (words.size() == 1 && words[0] == "head") {
        fmt::print(
            "case,sites,rate_hz,bar_ms,pushes,missed,share_within,median_ms,p90_ms,p99_ms,max_ms,"
            "stamp_ms,"
            "site_ms,world_ms,send_ms,touch_ms,capture_to_publish_ms,capture_to_collision_ms,"
            "skipped_ticks\n");
        return 0;
    }
    if (words.size() == 1) return fmt::print(stderr, "{}", kUsage), 2;
    Case c{words[0], words[1], std::stoul(words[2]), std::chrono::seconds(std::stoul(words[3]))};
    if (words.size() == 5) c.rate_hz = std::stod(words[4]);
    if (!(c.rate_hz >= 1.0 && c.rate_hz <= 240.0)) return fmt::print(stderr, "{}", kUsage), 2;
    if (const auto entered = bench::enter_own_host(); !entered) fail(3, entered.error().message);
    bus::BusOptions options;
    options.world = "world-latency";
    options.network = kNetwork;
    Programs programs(c, options);
    Observer observer(c, options);
    if (!observer.wait_for_all(programs))
        fail(1, "timeout: a site or the world server did not appear");
    observer.watch(c.length);
    programs.check();
    print(c, observer);
    programs.finish();
    return 0;
}
