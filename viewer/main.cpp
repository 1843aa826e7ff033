#include "core/app/log.hpp"
#include "core/app/process.hpp"
#include "core/app/program.hpp"
#include "viewer/viewer.hpp"

int main(int argc, char** argv) {
    using namespace atrium;
    const app::StopOnSignal stop;
    viewer::ViewerConfig config;
    config::OptionSet options;
    viewer::declare(config, options);
    const app::Start start = app::start(
        {.name = "viewer",
         .summary = "Shows the people and objects of a world from any viewpoint, in a window or, "
                    "without one, in pictures and videos.",
         .examples = "  viewer --config deploy/viewer.toml\n"
                     "  viewer --headless --wait_people 2 --frames 30 --output both.png\n"
                     "  viewer --headless --seconds 20 --video.file world.avi\n"},
        options,
        argc,
        argv);
    if (!start.go_on) return start.exit_code;
    app::apply(config.process);
    auto viewer =
        viewer::Viewer::create(config, stop.token(), viewer::Viewer::SurfaceIs::kOpenedNow);
    if (!viewer) return stop.token().stop_requested() ? 0 : app::fail(viewer.error());
    if (auto done = (*viewer)->run(stop.token()); !done) return app::fail(done.error());
    return 0;
}
