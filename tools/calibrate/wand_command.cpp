#include "core/config/rig.hpp"
#include "tools/calibrate/formats/rig_file.hpp"
#include "tools/calibrate/frame_options.hpp"
#include "tools/calibrate/progress.hpp"
#include "tools/calibrate/subcommands.hpp"
#include "tools/calibrate/wand/judge_wand.hpp"
#include "tools/calibrate/wand/light_points.hpp"
#include "tools/calibrate/wand/solve_wand.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;

struct WandCommand {
    fs::path points;
    fs::path wand;
    fs::path like;
    std::optional<std::array<int, 2>> size;
    double focal_px = 0.0;
    bool has_third = false;
    bool force = false;
    int threads = 0;  // 0: one per processor
    fs::path output;
    Said said;
};

Expected<std::vector<NominalCamera>> nominal_cameras(const WandCommand& options,
                                                     const LightPoints& points) {
    std::vector<NominalCamera> cameras;
    std::optional<config::Rig> like;
    if (!options.like.empty()) {
        auto rig = config::load_rig(options.like);
        if (!rig) return tl::unexpected(rig.error());
        like = std::move(*rig);
    } else if (!options.size) {
        return make_error(ErrorKind::kConfiguration,
                          "the points do not tell the size of the pictures: give --size "
                          "WIDTHxHEIGHT, or --like RIG with cameras of these names");
    }
    for (const LightCamera& camera : points) {
        NominalCamera nominal{camera.name, 0, 0, options.focal_px};
        if (options.size) {
            nominal.width = (*options.size)[0];
            nominal.height = (*options.size)[1];
        }
        if (like) {
            const auto found =
                std::ranges::find(like->cameras, camera.name, &geometry::CalibratedCamera::name);
            if (found == like->cameras.end())
                return make_error(ErrorKind::kConfiguration,
                                  fmt::format("{}: has no camera '{}', which {} names",
                                              options.like.string(),
                                              camera.name,
                                              options.points.string()));
            nominal.width = found->intrinsics.width;
            nominal.height = found->intrinsics.height;
            if (nominal.focal_px == 0.0)
                nominal.focal_px = 0.5 * (found->intrinsics.fx + found->intrinsics.fy);
        }
        for (const LightPoint& point : camera.points) {
            if (point.px.x() < -0.5 || point.px.y() < -0.5 || point.px.x() > nominal.width - 0.5 ||
                point.px.y() > nominal.height - 0.5)
                return make_error(
                    ErrorKind::kConfiguration,
                    fmt::format("camera '{}', instant {}: a point at ({:.0f}, {:.0f}) is outside "
                                "of a picture of {}x{} px; which size do the pictures have?",
                                camera.name,
                                point.instant,
                                point.px.x(),
                                point.px.y(),
                                nominal.width,
                                nominal.height));
        }
        cameras.push_back(nominal);
    }
    if (cameras.size() < 2)
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("{}: has one camera; a wand calibrates several", options.points.string()));
    return cameras;
}

// As cameras of another program that are known to be in metres, but in no frame of a room.
ForeignRig as_foreign(const WandSolution& solution) {
    ForeignRig rig;
    const bool has_scale = solution.bundle.wand.size() > 1;
    rig.format = has_scale ? "the wand" : "a wand with one light";
    rig.is_sure_of_poses = true;
    rig.units = "m";
    rig.has_scale = has_scale;
    rig.has_frame = false;
    for (const BundleCamera& camera : solution.bundle.cameras) {
        ForeignCamera foreign;
        foreign.name = camera.name;
        foreign.lens = camera.intrinsics();
        foreign.has_lens = true;
        foreign.pose = foreign_pose(camera.camera_from_world(), rig.documented);
        rig.cameras.push_back(std::move(foreign));
    }
    return rig;
}

Expected<void> refuse_to_write(const WandCommand& options,
                               const std::vector<std::string>& problems) {
    return make_error(
        ErrorKind::kInvalidData,
        fmt::format("{} not written: solve {} above first, or give --force",
                    options.output.string(),
                    problems.size() == 1 ? "the problem"
                                         : fmt::format("the {} problems", problems.size())));
}

Expected<void> run_wand(WandCommand options) {
    std::error_code failure;
    if (!options.force && fs::exists(options.output, failure))
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}: exists already; give another -o, or --force to replace "
                                      "it",
                                      options.output.string()));
    Wand wand = default_wand();
    if (!options.wand.empty()) {
        auto loaded = load_wand(options.wand);
        if (!loaded) return tl::unexpected(loaded.error());
        wand = std::move(*loaded);
    }
    const auto points = load_light_points(options.points);
    if (!points) return tl::unexpected(points.error());
    if (const std::string twins = same_pictures(*points); !twins.empty())
        return make_error(ErrorKind::kInvalidData, twins);
    const auto nominal = nominal_cameras(options, *points);
    if (!nominal) return tl::unexpected(nominal.error());
    WandOptions how;
    how.lens = options.has_third ? LensFreedom::kAllAndThird : LensFreedom::kAll;
    how.num_threads = options.threads > 0
                          ? options.threads
                          : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    const auto solution = [&] {
        Progress progress;
        how.report = [&](const std::string& step) { progress.show(step); };
        return solve_wand(wand, *nominal, *points, how);
    }();
    if (!solution) return tl::unexpected(solution.error());
    Verdict verdict = judge_wand(*solution, options.said.rate_hz);
    const auto conclusion = conclude(as_foreign(*solution), options.said);
    if (!conclusion) return tl::unexpected(conclusion.error());
    const auto add = [](std::vector<std::string>& to, const std::vector<std::string>& from) {
        to.insert(to.end(), from.begin(), from.end());
    };
    add(verdict.told, conclusion->told);
    add(verdict.checks, conclusion->checks);
    add(verdict.problems, conclusion->problems);
    for (const std::string& line : verdict.told) fmt::print("{}\n", line);
    for (const std::string& line : verdict.checks) fmt::print("check: {}\n", line);
    for (const std::string& line : verdict.problems) fmt::print("problem: {}\n", line);
    if (!verdict.problems.empty() && !options.force)
        return refuse_to_write(options, verdict.problems);
    std::vector<std::string> comments{
        fmt::format("Calibrated from {} by `calibrate wand`.", options.points.string())};
    add(comments, verdict.told);
    for (const std::string& line : verdict.checks) comments.push_back("check: " + line);
    for (const std::string& line : verdict.problems) comments.push_back("problem: " + line);
    if (auto written =
            write_text(options.output, rig_text(conclusion->rig, comments), options.force);
        !written)
        return written;
    fmt::print("wrote {}\n", options.output.string());
    return {};
}

}  // namespace

void add_wand(CLI::App& app, Action& action) {
    auto options = std::make_shared<WandCommand>();
    CLI::App* command = app.add_subcommand(
        "wand", "makes a rig.toml from the lights of a wand that was swept through the room");
    command->footer(
        "Examples:\n"
        "  calibrate wand --points sweep.csv --size 1280x1024 -o lab.toml\n"
        "  calibrate wand --points sweep.csv --wand wand.toml --like old.toml -o lab.toml\n"
        "The default wand has four lights on a line, at 0, 10, 30 and 60 cm.\n"
        "Exit codes: 0 done, 1 a damaged file or a calibration that is wrong, 2 wrong command line "
        "or file, 3 a file is missing or cannot be written.");
    command
        ->add_option("--points",
                     options->points,
                     "CSV of bright points: camera,instant,light,x_px,y_px; light may be empty")
        ->required()
        ->type_name("FILE");
    command
        ->add_option("--wand",
                     options->wand,
                     "TOML of the wand: a [[light]] with position_m = [x, y, z] for each light")
        ->type_name("FILE");
    command
        ->add_option_function<std::string>(
            "--size",
            [options](const std::string& text) { options->size = parse_size(text); },
            "size of all cameras' pictures")
        ->type_name("WIDTHxHEIGHT");
    command
        ->add_option("--like",
                     options->like,
                     "rig.toml whose cameras have these names: sizes and nominal focal lengths")
        ->type_name("RIG");
    command
        ->add_option("--focal-px",
                     options->focal_px,
                     "nominal focal length of all cameras in pixels; may be off by a third; "
                     "default: of --like, else the width of the picture")
        ->check(CLI::Range(10.0, 100000.0));
    command->add_flag("--k3", options->has_third, "also adjust the distortion k3: for wide lenses");
    command->add_option("--rate", options->said.rate_hz, "instants per second")
        ->check(CLI::Range(0.1, 1000.0))
        ->capture_default_str();
    command->add_option("--threads", options->threads, "threads; default: one per processor")
        ->check(CLI::Range(1, 256));
    add_up_option(*command, options->said);
    add_distance_options(*command, options->said);
    command->add_option("-o,--output", options->output, "rig.toml to write")->required();
    command->add_flag(
        "--force", options->force, "replace what -o names, and write in spite of problems");
    command->callback([options, &action] { action = [options] { return run_wand(*options); }; });
}

}  // namespace atrium::calibrate
