#include "core/config/rig.hpp"
#include "tools/calibrate/calibrated_rig.hpp"
#include "tools/calibrate/progress.hpp"
#include "tools/calibrate/refine/judge_refined.hpp"
#include "tools/calibrate/refine/refine.hpp"
#include "tools/calibrate/refine/take.hpp"
#include "tools/calibrate/subcommands.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <thread>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;

struct RefineCommand {
    fs::path rig;
    fs::path recording;
    std::vector<std::string> cameras;
    bool has_free_focal = false;
    bool force = false;
    int instants = 160;
    fs::path output;
};

Expected<std::vector<std::size_t>> find_cameras(const RefineCommand& options,
                                                const config::Rig& rig) {
    std::vector<std::size_t> found;
    for (const std::string& name : options.cameras) {
        const auto camera = std::ranges::find(rig.cameras, name, &geometry::CalibratedCamera::name);
        if (camera == rig.cameras.end()) {
            std::vector<std::string> names;
            for (const auto& one : rig.cameras) names.push_back(one.name);
            return make_error(ErrorKind::kConfiguration,
                              fmt::format("--camera {}: no camera has this name; {} has {}",
                                          name,
                                          options.rig.string(),
                                          fmt::join(names, ", ")));
        }
        found.push_back(static_cast<std::size_t>(camera - rig.cameras.begin()));
    }
    return found;
}

Expected<void> run_refine(const RefineCommand& options) {
    if (!options.output.empty())
        if (auto free = check_output(options.output, options.force); !free) return free;
    auto rig = config::load_rig(options.rig);
    if (!rig) return tl::unexpected(rig.error());
    if (rig->cameras.size() < 3)
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}: has two cameras; silhouettes tell the poses of three "
                                      "or more",
                                      options.rig.string()));
    const auto cameras = find_cameras(options, *rig);
    if (!cameras) return tl::unexpected(cameras.error());
    RefineOptions how;
    how.cameras = *cameras;
    how.has_free_focal = options.has_free_focal;
    how.num_threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    Expected<Take> take = make_error(ErrorKind::kInternal, "");
    Expected<Refined> refined = make_error(ErrorKind::kInternal, "");
    {
        Progress progress;
        TakeOptions reading;
        reading.most_sights = static_cast<std::size_t>(options.instants);
        reading.report = [&](const std::string& step) { progress.show(step); };
        take = read_take(options.recording, rig->cameras, reading);
        if (!take) return tl::unexpected(take.error());
        progress.show("adjusting the cameras");
        refined = refine(rig->cameras, take->sights, how);
    }
    if (!refined) return tl::unexpected(refined.error());
    const RefinedVerdict verdict =
        judge_refined(*refined, rig->cameras, *take, options.cameras.empty());
    const RigReport report{
        fmt::format("Refined from {} by `calibrate refine`, with the silhouettes of {}.",
                    options.rig.string(),
                    options.recording.string()),
        verdict.told,
        {},
        verdict.problems};
    if (options.output.empty()) {
        print(report);
        if (!verdict.problems.empty() && !options.force)
            return make_error(
                ErrorKind::kInvalidData,
                "the refinement is not good: " + cure_of_problems(verdict.problems.size()));
        fmt::print("nothing written: give -o FILE\n");
        return {};
    }
    rig->cameras = refined->cameras;
    if (!rig->has_bounds) rig->bounds_site = {};  // they follow from the cameras
    return print_and_write(report, *rig, options.output, options.force);
}

}  // namespace

void add_refine(CLI::App& app, Action& action) {
    auto options = std::make_shared<RefineCommand>();
    CLI::App* command = app.add_subcommand(
        "refine", "mends a rig.toml from the silhouettes of a person who walks through the room");
    command->footer(
        "Examples:\n"
        "  calibrate refine lab.toml --recording walk -o better.toml\n"
        "  calibrate refine lab.toml --recording walk --camera north -o mended.toml\n"
        "The rig may be off by about 1 degree and 3 cm (docs/calibrate_refine.md).\n"
        "Exit codes: 0 done, 1 a damaged file or a rig that does not become better, 2 wrong "
        "command line or file, 3 a file is missing or cannot be written.");
    command->add_option("rig", options->rig, "rig.toml to start from")
        ->required()
        ->type_name("RIG");
    command
        ->add_option("--recording",
                     options->recording,
                     "folder of a recording by these cameras in which a person walks")
        ->required()
        ->type_name("DIR");
    command
        ->add_option("--camera",
                     options->cameras,
                     "only this camera may move; commas between several; default: all")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->type_name("NAME,...");
    command->add_flag("--focal", options->has_free_focal, "also adjust the focal lengths");
    command->add_option("--instants", options->instants, "instants of the recording that are used")
        ->check(CLI::Range(1, 5000))
        ->capture_default_str();
    command->add_option("-o,--output",
                        options->output,
                        "rig.toml to write; one that it replaces is kept. Default: only report");
    command->add_flag(
        "--force", options->force, "write in spite of problems, and replace a file that is no rig");
    command->callback([options, &action] { action = [options] { return run_refine(*options); }; });
}

}  // namespace atrium::calibrate
