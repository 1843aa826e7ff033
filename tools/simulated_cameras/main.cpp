#include "core/app/program.hpp"
#include "tools/simulated_cameras/command.hpp"
#include "tools/simulated_cameras/program.hpp"

#include <algorithm>
#include <string>
#include <vector>

int main(int argc, char** argv) {
    using namespace atrium;
    // arguments after "--" belong to the command
    char** const separator =
        std::find_if(argv, argv + argc, [](const char* word) { return std::string(word) == "--"; });
    std::vector<std::string> command;
    if (separator != argv + argc) command.assign(separator + 1, argv + argc);

    simulated_cameras::SimulatedCamerasConfig config;
    config::OptionSet options;
    simulated_cameras::declare(config, options);
    const app::ProgramInfo info{
        "simulated_cameras",
        "Serves a simulated room, or a recording, as GigE Vision cameras in a private network, and "
        "runs a command there:\nsimulated_cameras [OPTIONS] -- COMMAND [ARGUMENTS]",
        "  simulated_cameras --rig deploy/rigs/full_body_1mp.toml --list\n"
        "  simulated_cameras --rig deploy/rigs/full_body.toml --simulation.motion stroll "
        "--write_recording walk\n"
        "  simulated_cameras --rig deploy/rigs/full_body_1mp.toml --empty_seconds 15 -- "
        "build/bin/site_node --config deploy/sites/simulated_cameras.toml",
        {},
        "that of COMMAND once it runs"};
    const app::Start start = app::start(info, options, static_cast<int>(separator - argv), argv);
    if (!start.go_on) return start.exit_code;
    auto plan = simulated_cameras::make_plan(config, command);
    if (!plan) return app::fail(plan.error());
    if (config.list) {
        simulated_cameras::print(*plan);
        return 0;
    }
    if (!config.write_recording.empty()) {
        const app::StopOnSignal stop;
        const auto written = simulated_cameras::write(*plan, stop.token());
        return written ? 0 : app::fail(written.error());
    }
    // namespaces and signals: while there is one thread
    if (auto entered = simulated_cameras::enter_network(*plan); !entered)
        return app::fail(entered.error());
    simulated_cameras::block_usr1();
    const app::StopOnSignal stop;
    const auto exit_code = simulated_cameras::run(*plan, stop.token());
    if (!exit_code) return stop.token().stop_requested() ? 0 : app::fail(exit_code.error());
    return *exit_code;
}
