#include "core/app/process.hpp"
#include "core/app/program.hpp"
#include "core/bus/bus_options.hpp"
#include "world_server/config.hpp"
#include "world_server/recorded_run.hpp"
#include "world_server/world_server.hpp"

int main(int argc, char** argv) {
    using namespace atrium;
    const app::StopOnSignal stop;
    world_server::WorldServerConfig config;
    config::OptionSet options;
    world_server::declare(config, options);
    const app::ProgramInfo info{
        .name = "world_server",
        .summary =
            "Simulates one physical world with the people of all sites and publishes the state of "
            "its objects.",
        .examples =
            "  world_server --config deploy/worlds/demo.toml\n"
            "  world_server --config deploy/worlds/playroom.toml --network lan\n"
            "  world_server --config deploy/worlds/playroom.toml --recording evening.mcap",
        .check = [&]() -> Expected<void> {
            if (auto fine = world_server::check(config); !fine) return fine;
            if (!config.recording.file.empty()) return {};  // joins no world
            std::string of_world;
            return bus::enter_keys(config.bus, keys::Kind::kWorld, of_world);
        },
        .check_files = [&] { return world_server::check_recording(config.recording); }};
    const app::Start start =
        app::start(info, options, argc, argv, [&](config::TableReader& reader) {
            world_server::read_world(reader, config);
        });
    if (!start.go_on) return start.exit_code;
    app::apply(config.process);

    if (!config.recording.file.empty()) {
        const auto done = world_server::run_recorded(config, stop.token());
        return done ? 0 : app::fail(done.error());
    }
    auto server = world_server::WorldServer::create(config, stop.token());
    if (!server) return stop.token().stop_requested() ? 0 : app::fail(server.error());
    if (const auto done = (*server)->run(stop.token()); !done) return app::fail(done.error());
    return 0;
}
