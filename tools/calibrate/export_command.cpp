#include "core/config/rig.hpp"
#include "tools/calibrate/formats/format.hpp"
#include "tools/calibrate/subcommands.hpp"

#include <fmt/format.h>

namespace atrium::calibrate {
namespace {

struct ExportOptions {
    std::filesystem::path rig;
    std::string format;
    std::filesystem::path output;
    bool force = false;
};

Expected<void> run_export(const ExportOptions& options) {
    const auto rig = config::load_rig(options.rig);
    if (!rig) return tl::unexpected(rig.error());
    std::error_code failure;
    if (!options.force && std::filesystem::exists(options.output, failure)) {
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("{}: exists already; give another -o, or --force to replace it",
                        options.output.string()));
    }
    const auto lost = write_foreign(*rig, *format_of(options.format), options.output);
    if (!lost) return tl::unexpected(lost.error());
    for (const std::string& line : *lost) fmt::print("lost: {}\n", line);
    fmt::print("wrote {}: {} cameras\n", options.output.string(), rig->cameras.size());
    return {};
}

}  // namespace

void add_export(CLI::App& app, Action& action) {
    auto options = std::make_shared<ExportOptions>();
    CLI::App* command =
        app.add_subcommand("export", "writes a rig.toml as the calibration of another program");
    command->footer(
        "Examples:\n"
        "  calibrate export lab.toml --format opencv -o lab.yml      (or .xml, .json)\n"
        "  calibrate export lab.toml --format colmap -o sparse/0\n"
        "What a format cannot hold is printed as a line that begins with 'lost'.");
    command->add_option("rig", options->rig, "rig.toml, or the folder of a recording")
        ->required()
        ->type_name("RIG");
    command->add_option("--format", options->format, "program that shall read the file")
        ->required()
        ->check(CLI::IsMember(format_names()));
    command->add_option("-o,--output", options->output, "file to write; for colmap a folder")
        ->required();
    command->add_flag("--force", options->force, "replace what -o names");
    command->callback([options, &action] { action = [options] { return run_export(*options); }; });
}

}  // namespace atrium::calibrate
