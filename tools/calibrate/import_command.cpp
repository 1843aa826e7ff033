#include "core/app/process.hpp"
#include "tools/calibrate/frame_options.hpp"
#include "tools/calibrate/import.hpp"
#include "tools/calibrate/subcommands.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <utility>

namespace atrium::calibrate {
namespace {

void add_frame_options(CLI::App& command, Said& said) {
    command.add_option("--units", said.units, "unit of the file's lengths; default: found out")
        ->check(CLI::IsMember({"m", "cm", "mm", "in", "ft"}));
    command
        .add_option_function<std::string>(
            "--direction",
            [&said](const std::string& word) {
                said.pose = word == "camera_from_site"   ? Reading::Pose::kCameraFromSite
                            : word == "site_from_camera" ? Reading::Pose::kSiteFromCamera
                            : word == "transposed"       ? Reading::Pose::kTransposed
                                                         : Reading::Pose::kRotationAndPosition;
            },
            "what rotation R and translation t of the file do. camera_from_site: R * p + t takes a "
            "point p of the room to the camera; site_from_camera: from the camera to the room; "
            "position: t is where the camera stands, and R turns the room into the camera; "
            "transposed: camera_from_site with the transpose of R, as MATLAB's RotationMatrix; "
            "default: found out")
        ->check(CLI::IsMember({"camera_from_site", "site_from_camera", "position", "transposed"}));
    command
        .add_option_function<std::string>(
            "--axes",
            [&said](const std::string& word) { said.opengl = word == "opengl"; },
            "axes of a camera: it looks along +Z with +Y down (opencv), or along -Z with +Y up "
            "(opengl); default: found out")
        ->check(CLI::IsMember({"opencv", "opengl"}));
    command.add_flag("--left-handed",
                     said.left_handed,
                     "the frames of the room and of the cameras (+Y up, +Z ahead) are left-handed, "
                     "as of Unity: mirror them");
    add_up_option(command, said);
    add_distance_options(command, said);
}

void add_picture_options(CLI::App& command, ImportOptions& options) {
    Said& said = options.said;
    command
        .add_option_function<std::string>(
            "--size",
            [&said](const std::string& text) { said.size = parse_size(text); },
            "size of the pictures in pixels, if the file says none or they were scaled")
        ->type_name("WIDTHxHEIGHT");
    command
        .add_option_function<std::string>(
            "--calibrated-size",
            [&said](const std::string& text) {
                said.calibrated_size = parse_size(text, "--calibrated-size");
            },
            "size in pixels of the pictures from which the cameras were calibrated, if the file "
            "says none or a wrong one; for other pictures the lenses are scaled")
        ->type_name("WIDTHxHEIGHT");
    command
        .add_option_function<std::string>(
            "--rate",
            [&options](const std::string& text) {
                const auto rate_hz = parse_number(text, 0.1, 1000.0);
                if (!rate_hz)
                    throw CLI::ValidationError("--rate",
                                               "must be pictures per second, a number of 0.1 to "
                                               "1000 without a unit, got " +
                                                   text + hint_of_comma(text));
                options.said.rate_hz = *rate_hz;
                options.has_rate = true;
            },
            "pictures per second; default: of the videos, else 30")
        ->type_name("NUMBER");
    auto* recording = command.add_option(
        "--recording",
        options.recording,
        "folder with the videos or pictures of these cameras; -o then names the folder of the new "
        "recording");
    command
        .add_option("--take",
                    options.take,
                    "of several recordings below --recording, the one whose folders or files have "
                    "names that match this pattern of a shell, or begin with it: 'Gait 0001'")
        ->needs(recording);
    command
        .add_option("--background",
                    options.background,
                    "folder with videos or pictures of the empty room; default: those below "
                    "--recording with background, bg, empty or plate in their names")
        ->needs(recording);
    command
        .add_option("--masks",
                    options.masks,
                    "folder with masks of the people as pictures, one per picture of each camera; "
                    "default: those below --recording with mask, silhouette, matte or seg in their "
                    "names; none: no masks, not even those")
        ->needs(recording);
    command
        .add_flag("--invert-masks",
                  options.invert_masks,
                  "people are black in the masks: write inverted copies instead of links")
        ->needs(recording);
    command.add_flag("--copy", options.copy, "copy the pictures instead of linking them")
        ->needs(recording);
}

// "build/bin/" or the like, so that the commands of `next:` run; empty for programs on the PATH.
std::string programs_prefix() {
    namespace fs = std::filesystem;
    const fs::path folder = app::program_folder();
    std::error_code failure;
    const char* search = std::getenv("PATH");
    std::istringstream folders(search == nullptr ? "" : search);
    for (std::string entry; std::getline(folders, entry, ':');) {
        if (fs::equivalent(entry, folder, failure)) return {};
    }
    const fs::path relative = folder.lexically_relative(fs::current_path(failure));
    const bool is_below = !relative.empty() && *relative.begin() != "..";
    return folder.empty()
               ? std::string()
               : ((is_below ? fs::path(".") / relative : folder).lexically_normal() / "").string();
}

// Where the commands of `next:` run: their paths may be relative.
std::string place_text(const ImportOptions& options) {
    const bool has_folder = !options.programs.empty();
    if (options.output.is_absolute() &&
        (!has_folder || std::filesystem::path(options.programs).is_absolute()))
        return {};
    std::error_code failure;
    const std::filesystem::path here = std::filesystem::current_path(failure);
    return failure ? ", in this folder" : ", in the folder " + here.string();
}

Expected<void> run_import(const ImportOptions& options) {
    const auto report = import(options);
    if (!report) return tl::unexpected(report.error());
    for (const std::string& line : report->told) fmt::print("{}\n", line);
    for (const std::string& line : report->checks) fmt::print("check: {}\n", line);
    for (const std::string& line : report->problems) fmt::print("problem: {}\n", line);
    fmt::print("wrote {}\n", options.output.string());
    if (!report->problems.empty()) {
        fmt::print("solve first: {} above\n",
                   report->problems.size() == 1
                       ? "the problem"
                       : fmt::format("the {} problems", report->problems.size()));
    }
    fmt::print("next: in three terminals{}{}\n",
               place_text(options),
               options.recording.empty()
                   ? "; a simulated person stands in the room, as your cameras would see it"
                   : "");
    for (const std::string& command : report->next) fmt::print("    {}\n", command);
    return {};
}

constexpr const char* kImportExamples =
    "Examples:\n"
    "  calibrate import Calibration.qca.txt -o lab.toml\n"
    "  calibrate import intri.yml extri.yml --recording take3 -o recordings/take3\n"
    "  calibrate import colmap/sparse/0 --distance cam1 cam2 2.35 -o lab.toml\n"
    "Exit codes: 0 done, 1 a damaged file, 2 wrong command line or calibration, 3 a file is "
    "missing "
    "or cannot be written.";

}  // namespace

void add_import(CLI::App& app, Action& action) {
    auto options = std::make_shared<ImportOptions>();
    CLI::App* command = app.add_subcommand(
        "import", "makes a rig.toml, or a recording, from the calibration of another program");
    command->footer(kImportExamples);
    command
        ->add_option("files",
                     options->files,
                     "calibration files, a folder of them, or the folder of COLMAP or of its model")
        ->required()
        ->type_name("FILE");
    command
        ->add_option("-o,--output",
                     options->output,
                     "file to write, rig.toml of the room; with --recording: the folder of the new "
                     "recording")
        ->required();
    std::vector<std::string> formats = format_names();
    formats.insert(formats.begin(), "auto");
    command->add_option("--format", options->format, "program that wrote the files")
        ->check(CLI::IsMember(formats))
        ->capture_default_str();
    command
        ->add_option("--cameras",
                     options->cameras,
                     "only the cameras with these names, or patterns of a shell such as '00_*'; "
                     "'!NAME' leaves one out; commas between several; default: all")
        ->type_name("NAME,...")
        ->delimiter(',')
        ->allow_extra_args(false);
    add_frame_options(*command, options->said);
    add_picture_options(*command, *options);
    command->add_flag("--force", options->force, "replace what -o names");
    options->programs = programs_prefix();
    command->callback([options, &action] { action = [options] { return run_import(*options); }; });
}

}  // namespace atrium::calibrate
