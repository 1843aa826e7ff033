#include "core/app/program.hpp"
#include "core/bus/bus_options.hpp"
#include "viewer/receive/session.hpp"

#include <fmt/format.h>

#include <cstdio>

// A viewer that draws nothing. It receives, pairs and reports to the sites like any viewer, and
// prints when each frame was complete: "frame ID CAPTURE_NS COMPLETE_NS".
int main(int argc, char** argv) {
    using namespace atrium;
    const app::StopOnSignal stop;
    bus::BusOptions bus_options;
    config::OptionSet options;
    bus::declare(bus_options, options);
    const app::Start start =
        app::start({.name = "stream_viewer",
                    .summary = "Receives what sites publish, and says when.",
                    .examples = "  stream_viewer --network wan --peers 10.77.0.1\n"},
                   options,
                   argc,
                   argv);
    if (!start.go_on) return start.exit_code;
    auto session = viewer::Session::create(bus_options, "stream_viewer");
    if (!session) return app::fail(session.error());
    (*session)->on_complete([](const viewer::FramePair& pair) {
        fmt::print(
            "frame {} {} {}\n", pair.mesh.frame_id, pair.mesh.capture_time.ns, Timestamp::now().ns);
        std::fflush(stdout);
    });
    (*session)->receive(stop.token());
    fmt::print("incomplete {}\n", (*session)->num_incomplete());
    return 0;
}
