#include "core/app/log.hpp"
#include "core/app/program.hpp"
#include "tools/calibrate/subcommands.hpp"

#include <cstdio>

int main(int argc, char** argv) {
    using namespace atrium;
    CLI::App app{"Makes and converts calibrations of cameras (docs/calibrate.md).", "calibrate"};
    app.set_version_flag("--version", "calibrate " + app::version());
    app.require_subcommand(1);
    calibrate::Action action;
    calibrate::add_import(app, action);
    calibrate::add_export(app, action);
    calibrate::add_wand(app, action);
    calibrate::add_refine(app, action);
    calibrate::add_check(app, action);
    calibrate::add_board(app, action);
    calibrate::add_print_board(app, action);
    calibrate::add_floor(app, action);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
        constexpr int kExitUsage = 2;
        std::fprintf(
            stderr, "calibrate: error: %s\n", calibrate::usage_error(app, error.what()).c_str());
        return kExitUsage;
    }
    app::log::set_program("calibrate");
    app::log::set_level(app::log::Level::kWarn);
    if (const auto done = action(); !done) {
        std::fprintf(stderr, "calibrate: error: %s\n", done.error().message.c_str());
        return app::exit_code(done.error());
    }
    return 0;
}
