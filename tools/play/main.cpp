#include "core/app/program.hpp"
#include "core/bus/bus_options.hpp"
#include "tools/play/play.hpp"

int main(int argc, char** argv) {
    using namespace atrium;
    const app::StopOnSignal stop;
    play::PlayConfig config;
    config.bus.world.clear();
    config::OptionSet options;
    play::declare(config, options);
    const app::ProgramInfo info{
        .name = "play",
        .summary =
            "Plays a recording of a world (`atrium record`): the same samples at their times, for "
            "viewers, monitors and world servers. Keys: space, arrows, , . + - 1 l i o x 0 q.",
        .examples =
            "  atrium play evening.mcap --info\n"
            "  atrium play evening.mcap --loop\n"
            "  atrium play evening.mcap --sites alice --rename alice=anna --world studio\n",
        .only_prints = [&] { return config.info; },
        .check = [&]() -> Expected<void> {
            if (auto fine = play::check(config); !fine) return fine;
            if (auto entered = bus::enter_keys(config.bus); !entered) return entered;
            if (!config.bus.keys) return {};
            return make_error(ErrorKind::kConfiguration,
                              "bus.security: play publishes in the names of all whom the recording "
                              "has, and no keys allow that; play into a world without keys: "
                              "--security none");
        },
        .positional = "file"};
    const app::Start start = app::start(info, options, argc, argv);
    if (!start.go_on) return start.exit_code;
    const auto done = play::run_play(config, stop.token());
    return done ? 0 : app::fail(done.error());
}
