#include "core/app/log.hpp"
#include "core/app/process.hpp"
#include "core/app/program.hpp"
#include "core/bus/bus_options.hpp"
#include "viewer/run_viewer.hpp"

#include <utility>

int main(int argc, char** argv) {
    using namespace atrium;
    const app::StopOnSignal stop;
    viewer::ViewerConfig config;
    config.bus.world.clear();  // without one the user chooses
    config::OptionSet options;
    viewer::declare(config, options);
    const app::Start start = app::start(
        {.name = "viewer",
         .summary =
             "Shows the people and objects of a world from any viewpoint, in a window or, "
             "without one, in pictures and videos. Without --bus.world it lists the worlds that "
             "it hears. Also shows a recording (atrium record).",
         .examples = "  viewer\n"
                     "  viewer --config deploy/viewer.toml\n"
                     "  viewer --headless --wait_people 2 --frames 30 --output both.png\n"
                     "  viewer --headless --seconds 20 --video.file world.avi\n"
                     "  viewer evening.mcap\n"
                     "  viewer evening.mcap --path way.json --video.file film.mp4\n",
         .check = [&config]() -> Expected<void> {
             if (auto fine = viewer::check_recording(config); !fine) return fine;
             if (!config.recording.file.empty()) return {};  // joins no world
             return bus::enter_keys(config.bus, keys::Kind::kViewer, config.view.name);
         },
         .positional = "recording.file"},
        options,
        argc,
        argv,
        [&config](config::TableReader& reader) {
            viewer::read_viewpoints(reader, config.viewpoints);
        });
    if (!start.go_on) return start.exit_code;
    app::apply(config.process);
    return viewer::run_viewer(std::move(config), stop.token());
}
