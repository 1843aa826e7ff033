#include "core/app/program.hpp"
#include "tools/demo/demo.hpp"

int main(int argc, char** argv) {
    using namespace atrium;
    demo::DemoConfig config;
    config::OptionSet options;
    demo::declare(config, options);
    const app::ProgramInfo info{"demo",
                                "Runs two simulated rooms, a world server and a viewer on this "
                                "host and shows a table of their status once a second.",
                                "  demo --seconds 60\n"
                                "  demo --config deploy/demos/ballpit.toml\n"};
    if (const app::Start start = app::start(info, options, argc, argv); !start.go_on)
        return start.exit_code;
    const app::StopOnSignal stop;
    const auto done = demo::run_demo(config, stop.token());
    return done ? 0 : app::fail(done.error());
}
