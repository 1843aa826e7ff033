#include "core/app/program.hpp"
#include "core/bus/bus_options.hpp"
#include "tools/monitor/monitor.hpp"

int main(int argc, char** argv) {
    using namespace atrium;
    const app::StopOnSignal stop;
    monitor::MonitorConfig config;
    config::OptionSet options;
    monitor::declare(config, options);
    const app::ProgramInfo info{
        .name = "monitor",
        .summary =
            "Shows the programs in a world, their rates and their losses, once a second. "
            "It only listens: no other program notices it.",
        .examples =
            "  monitor\n"
            "  monitor --bus.world atrium --network lan --site alice\n"
            "  monitor --json --seconds 60 > world.jsonl\n"
            "  monitor --once --wait 5\n",
        .only_prints = [] { return true; },
        .exit_codes = "3 if --once finds no program in the world",
        .check =
            [&] {
                std::string any;
                return bus::enter_keys(config.bus, keys::Kind::kMonitor, any);
            }};
    const app::Start start = app::start(info, options, argc, argv);
    if (!start.go_on) return start.exit_code;
    const auto done = monitor::run_monitor(config, stop.token());
    return done ? 0 : app::fail(done.error());
}
