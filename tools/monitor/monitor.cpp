#include "tools/monitor/monitor.hpp"

#include "core/base/split_list.hpp"
#include "core/bus/bus_options.hpp"
#include "tools/monitor/inbox.hpp"
#include "tools/monitor/render_json.hpp"
#include "tools/monitor/render_text.hpp"
#include "tools/monitor/screen.hpp"
#include "tools/monitor/world_model.hpp"

#include <fmt/format.h>

#include <chrono>

namespace atrium::monitor {
namespace {

using Clock = WorldModel::Clock;

Clock::duration from_seconds(double seconds) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

class Monitor {
public:
    Monitor(const MonitorConfig& config, Inbox inbox)
        : config_(config),
          sites_(split_list(config.sites)),
          inbox_(std::move(inbox)),
          model_(config.bus.world),
          screen_(!config.json && !config.once) {
        for (const std::string& warning : inbox_.participant().network().warnings)
            model_.notice(warning, Clock::now());
    }

    Expected<void> run(std::stop_token stop);

private:
    bool listen(Clock::time_point until, std::stop_token stop);
    std::vector<std::string> lines(const Report& report) const;

    const MonitorConfig& config_;
    std::vector<std::string> sites_;
    Inbox inbox_;
    WorldModel model_;
    Screen screen_;
};

// Takes samples until `until`. Returns false once a stop is requested.
bool Monitor::listen(Clock::time_point until, std::stop_token stop) {
    while (!stop.stop_requested()) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
        if (left.count() <= 0) break;
        inbox_.wait(left);
        inbox_.take(model_);
    }
    for (const std::string& line : inbox_.participant().take_mismatches())
        model_.notice(line, Clock::now());
    for (const std::string& line : inbox_.participant().take_dds_log())
        model_.notice(line, Clock::now());
    return !stop.stop_requested();
}

std::vector<std::string> Monitor::lines(const Report& report) const {
    if (config_.json) return {render_json(report)};
    std::vector<std::string> text = render_text(report,
                                                {.width = screen_.width(),
                                                 .height = screen_.height(),
                                                 .colour = screen_.has_colour(),
                                                 .sites = sites_});
    // empty line between two reports
    if (!screen_.is_in_place() && !config_.once) text.emplace_back();
    return text;
}

Expected<void> Monitor::run(std::stop_token stop) {
    const std::stop_callback wake(stop, [this] { inbox_.wake(); });
    const Clock::time_point begin = Clock::now();
    const Clock::time_point end =
        config_.seconds > 0.0 ? begin + from_seconds(config_.seconds) : Clock::time_point::max();
    Clock::time_point next =
        begin + (config_.once ? from_seconds(config_.wait_s) : std::chrono::seconds(1));
    for (;;) {
        const bool go_on = listen(std::min(next, end), stop);
        if (!go_on && config_.once) return {};
        const Report report = model_.report(Clock::now(), Timestamp::now());
        if (auto shown = screen_.show(lines(report)); !shown) return shown;
        if (config_.once && report.num_here() == 0) {
            return make_error(ErrorKind::kNotFound,
                              fmt::format("nobody is there: {}; world, domain and network must be "
                                          "the same in all programs",
                                          inbox_.participant().place()));
        }
        if (config_.once) return {};
        if (!go_on || Clock::now() >= end) {
            return screen_.leave(render_text(report,
                                             {.width = screen_.width(),
                                              .height = 0,
                                              .colour = screen_.has_colour(),
                                              .sites = sites_}));
        }
        next = std::max(next + std::chrono::seconds(1), Clock::now());
    }
}

}  // namespace

void declare(MonitorConfig& config, config::OptionSet& options) {
    options.add(
        "json", config.json, "print one JSON object per second, one per line (docs/monitor.md)");
    options.add("once",
                config.once,
                "print one report after --wait and exit: code 0, or 3 if the world is empty");
    options.add(
        "wait", config.wait_s, "time to listen before the report of --once [s]", {0.1, 3600});
    options.add("seconds", config.seconds, "stop after this time [s]; 0: until Ctrl-C", {0, 1e9});
    options.add(
        "site", config.sites, "sites, \"a,b\", whose cameras are shown; empty: all that fit");
    options.add(
        "measure",
        config.measure,
        "subscribe to all meshes, textures and states to measure them; sites then send them here "
        "as to one more viewer. Without it a monitor costs the others nothing, and shows the "
        "bytes per second that sites report");
    bus::declare(config.bus, options);
}

Expected<void> run_monitor(const MonitorConfig& config, std::stop_token stop) {
    auto inbox = Inbox::create(config.bus, config.measure);
    if (!inbox) return tl::unexpected(inbox.error());
    return Monitor(config, std::move(*inbox)).run(std::move(stop));
}

}  // namespace atrium::monitor
