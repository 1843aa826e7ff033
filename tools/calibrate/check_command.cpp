#include "core/config/rig.hpp"
#include "tools/calibrate/progress.hpp"
#include "tools/calibrate/refine/check_rig.hpp"
#include "tools/calibrate/refine/take.hpp"
#include "tools/calibrate/subcommands.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

namespace atrium::calibrate {
namespace {

struct CheckCommand {
    std::filesystem::path rig;
    std::filesystem::path recording;
    int instants = 160;
};

Expected<void> run_check(const CheckCommand& options) {
    const auto rig = config::load_rig(options.rig);
    if (!rig) return tl::unexpected(rig.error());
    RigCheck check;
    check_geometry(*rig, check);
    if (!options.recording.empty()) {
        Progress progress;
        TakeOptions reading;
        reading.most_sights = static_cast<std::size_t>(options.instants);
        reading.report = [&](const std::string& step) { progress.show(step); };
        const auto take = read_take(options.recording, rig->cameras, reading);
        if (!take) return tl::unexpected(take.error());
        progress.show("judging the cameras");
        check_silhouettes(*rig, *take, options.rig.string(), options.recording.string(), check);
    }
    for (const std::string& line : check.told) fmt::print("{}\n", line);
    for (const std::string& line : check.checks) fmt::print("check: {}\n", line);
    for (const std::string& line : check.problems) fmt::print("problem: {}\n", line);
    if (!check.problems.empty())
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{}: {} above",
                                      options.rig.string(),
                                      check.problems.size() == 1
                                          ? "the problem"
                                          : fmt::format("the {} problems", check.problems.size())));
    if (!check.checks.empty() && !options.recording.empty())
        fmt::print("usable: nothing certain is wrong\n");
    else
        fmt::print("good: {}\n",
                   options.recording.empty()
                       ? "nothing is wrong with the numbers; --recording DIR of a person who walks "
                         "tells whether they are still true"
                       : "nothing is wrong");
    return {};
}

}  // namespace

void add_check(CLI::App& app, Action& action) {
    auto options = std::make_shared<CheckCommand>();
    CLI::App* command = app.add_subcommand(
        "check", "says whether a rig.toml is still true, and which camera was moved");
    command->footer(
        "Examples:\n"
        "  calibrate check lab.toml\n"
        "  calibrate check lab.toml --recording walk\n"
        "Exit codes: 0 nothing is wrong, 1 a problem or a damaged file, 2 wrong command line or "
        "file, 3 a file is missing.");
    command->add_option("rig", options->rig, "rig.toml to check")->required()->type_name("RIG");
    command
        ->add_option("--recording",
                     options->recording,
                     "folder of a recording by these cameras in which a person walks")
        ->type_name("DIR");
    command->add_option("--instants", options->instants, "instants of the recording that are used")
        ->check(CLI::Range(1, 5000))
        ->capture_default_str();
    command->callback([options, &action] { action = [options] { return run_check(*options); }; });
}

}  // namespace atrium::calibrate
