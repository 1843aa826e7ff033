#include "core/app/program.hpp"
#include "core/bus/bus_options.hpp"
#include "tools/record/record.hpp"

int main(int argc, char** argv) {
    using namespace atrium;
    const app::StopOnSignal stop;
    record_tool::RecordConfig config;
    config::OptionSet options;
    record_tool::declare(config, options);
    const app::ProgramInfo info{
        .name = "record",
        .summary =
            "Records all topics of a world into an MCAP file: meshes, textures, states, commands. "
            "It only listens. `atrium play` and `viewer FILE` show it again.",
        .examples =
            "  atrium record -o evening.mcap\n"
            "  atrium record --world studio --network lan --sites alice -o alice.mcap\n"
            "  atrium record --site alice --raw monday   # the pictures of her cameras, on her "
            "host\n"
            "  atrium record --cut_mb 1000 --seconds 3600 -o day.mcap\n",
        .exit_codes = "3 also if nothing came, or the disk is full",
        .check = [&]() -> Expected<void> {
            if (auto fine = record_tool::check(config); !fine) return fine;
            std::string any;
            return bus::enter_keys(config.bus, keys::Kind::kMonitor, any);
        }};
    const app::Start start = app::start(info, options, argc, argv);
    if (!start.go_on) return start.exit_code;
    const auto done = record_tool::run_record(config, stop.token());
    return done ? 0 : app::fail(done.error());
}
