#include "viewer/start/choose_world.hpp"

#include "core/app/log.hpp"
#include "core/bus/world_listener.hpp"
#include "core/presence/heard_worlds.hpp"
#include "viewer/start/start_screen.hpp"

#include <fmt/format.h>

#include <condition_variable>
#include <mutex>
#include <utility>
#include <vector>

namespace atrium::viewer {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kPicturePeriod{16};
constexpr std::chrono::milliseconds kListenPeriod{200};

// Pauses between pictures. Returns early on a stop.
void pause(const std::stop_token& stop, std::chrono::milliseconds period) {
    std::mutex mutex;
    std::condition_variable_any never;
    std::unique_lock lock(mutex);
    never.wait_for(lock, stop, period, [] { return false; });
}

bool is_other_network(const bus::BusOptions& a, const bus::BusOptions& b) {
    return a.domain != b.domain || a.network != b.network || a.peers != b.peers;
}

// Hears worlds on the network that the user chose.
class Ear {
public:
    /// Empty: it works.
    std::string listen_on(const bus::BusOptions& options) {
        if (listener_ && !is_other_network(options, options_)) return failure_;
        if (!failure_.empty() && !is_other_network(options, options_)) return failure_;
        options_ = options;
        listener_.reset();  // first: a domain has one setting at a time
        auto created = bus::WorldListener::create(options);
        failure_ = created ? "" : created.error().message;
        if (created) listener_.emplace(std::move(*created));
        worlds_.clear();
        return failure_;
    }
    const std::vector<presence::HeardWorld>& worlds(Clock::time_point now) {
        if (listener_ && now - heard_at_ >= kListenPeriod) {
            heard_at_ = now;
            worlds_ = presence::worlds_of(listener_->heard());
        }
        return worlds_;
    }

private:
    bus::BusOptions options_;
    std::optional<bus::WorldListener> listener_;
    std::string failure_;
    Clock::time_point heard_at_;
    std::vector<presence::HeardWorld> worlds_;
};

}  // namespace

std::optional<bus::BusOptions> choose_world(Surface& surface,
                                            const bus::BusOptions& options,
                                            RecentWorlds& recent,
                                            const std::string& notice,
                                            std::stop_token stop) {
    StartScreen screen(options, notice);
    Ear ear;
    while (!stop.stop_requested() && !screen.is_left()) {
        if (surface.poll().close) return std::nullopt;
        screen.set_failure(ear.listen_on(screen.options()));
        const auto entries =
            world_entries(screen.options(), ear.worlds(Clock::now()), recent.list());
        surface.show_layout([&] { screen.draw(entries); });
        if (const auto forgotten = screen.take_forgotten()) {
            if (const auto kept = recent.forget(*forgotten); !kept)
                app::log::warn("recent_worlds_failed reason=\"{}\"", kept.error().message);
        }
        if (const auto& joined = screen.joined()) {
            // joining takes most of a second, in which the window draws nothing. ImGui hides a new
            // panel in its first frame, in which it finds its size.
            for (int frame = 0; frame < 2; ++frame)
                surface.show_layout([&] { draw_joining(joined->world); });
            return joined;
        }
        pause(stop, kPicturePeriod);
    }
    return std::nullopt;
}

Expected<WorldReport> report_worlds(const bus::BusOptions& options,
                                    std::chrono::milliseconds duration,
                                    std::stop_token stop) {
    auto listener = bus::WorldListener::create(options);
    if (!listener) return tl::unexpected(listener.error());
    pause(stop, duration);
    const auto worlds = presence::worlds_of(listener->heard());
    const std::string where = fmt::format("network {}, domain {}", options.network, options.domain);
    WorldReport report;
    report.has_worlds = !worlds.empty();
    if (worlds.empty()) {
        report.text = fmt::format(
            "No world is heard ({}). Start one: \"atrium demo\", or a world_server and a site_node "
            "on this network.\n",
            where);
    } else {
        report.text = fmt::format("Worlds heard ({}):\n", where);
        for (const presence::HeardWorld& world : worlds)
            report.text += fmt::format("  {:<20} {}\n", world.name, presence::describe(world));
        const std::string network =
            (options.network == "loopback" ? "" : " --network " + options.network) +
            (options.domain == 0 ? "" : fmt::format(" --bus.domain {}", options.domain));
        const std::string join =
            fmt::format("viewer --bus.world {}{}", worlds.front().name, network);
        report.text += fmt::format(
            "Join one in a window:    {}\n"
            "or make a picture of it: {} --headless --frames 30 --output world.png\n",
            join,
            join);
    }
    report.text +=
        "Not heard: worlds of other domains (--bus.domain) and networks (--network), of hosts "
        "beyond "
        "a router (--peers), and of other versions of Atrium.\n";
    return report;
}

}  // namespace atrium::viewer
