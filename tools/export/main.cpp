#include "core/app/program.hpp"
#include "tools/export/export.hpp"

int main(int argc, char** argv) {
    using namespace atrium;
    const app::StopOnSignal stop;
    exporting::ExportConfig config;
    config::OptionSet options;
    exporting::declare(config, options);
    const app::ProgramInfo info{
        .name = "export",
        .summary =
            "Exports the people of a recording (`atrium record`) for other programs: textured "
            "meshes, coloured meshes and point clouds, single or as a sequence.",
        .examples =
            "  atrium export evening.mcap --site alice --from 12.5 --to 20 -o alice.glb\n"
            "  atrium export evening.mcap --site alice --from 12.5 -o alice.obj   # one frame\n"
            "  atrium export evening.mcap --site alice --format obj -o folder\n"
            "  atrium export evening.mcap --path evening.path.json --frame world -o alice.glb\n",
        .exit_codes = "1 also if it is stopped before the end",
        .check = [&] { return exporting::check(config); },
        .positional = "file"};
    const app::Start start = app::start(info, options, argc, argv);
    if (!start.go_on) return start.exit_code;
    const auto done = exporting::run_export(config, stop.token());
    return done ? 0 : app::fail(done.error());
}
