#include "core/app/program.hpp"
#include "core/config/rig.hpp"
#include "tools/calibrate/finish_calibration.hpp"
#include "tools/calibrate/frame_options.hpp"
#include "tools/calibrate/progress.hpp"
#include "tools/calibrate/subcommands.hpp"
#include "tools/calibrate/sweep/keep_sweep.hpp"
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

// A sweep reaches into this share of the pictures at each side, in some camera.
constexpr double kBorder = 0.15;
constexpr std::size_t kManyPoints = 400;

struct WandCommand {
    fs::path points;
    fs::path wand;
    fs::path like;
    std::optional<std::array<int, 2>> size;
    double focal_px = 0.0;
    bool has_third = false;
    std::optional<double> rate_hz;
    int threads = 0;  // 0: one per processor
    FinishOptions finish;
    Said said;
    SweepOptions sweep;
};

// The points of a file, or of the pictures of a sweep, and what is known of their cameras.
struct WandInput {
    LightPoints points;
    std::vector<NominalCamera> nominal;
};

const geometry::CalibratedCamera* find_camera(const config::Rig& rig, const std::string& name) {
    const auto found = std::ranges::find(rig.cameras, name, &geometry::CalibratedCamera::name);
    return found == rig.cameras.end() ? nullptr : &*found;
}

// `sizes`: of the pictures of a sweep; empty for points of a file.
Expected<std::vector<NominalCamera>> nominal_cameras(const WandCommand& options,
                                                     const LightPoints& points,
                                                     const std::vector<NominalCamera>& sizes) {
    std::vector<NominalCamera> cameras;
    std::optional<config::Rig> like;
    if (!options.like.empty()) {
        auto rig = config::load_rig(options.like);
        if (!rig) return tl::unexpected(rig.error());
        like = std::move(*rig);
    } else if (!options.size && sizes.empty()) {
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
        if (!sizes.empty()) nominal = sizes[cameras.size()];
        if (options.focal_px > 0.0) nominal.focal_px = options.focal_px;
        if (like) {
            const auto* const found = find_camera(*like, camera.name);
            if (found == nullptr && !sizes.empty()) {
                cameras.push_back(nominal);  // a new one
                continue;
            }
            if (found == nullptr)
                return make_error(ErrorKind::kConfiguration,
                                  fmt::format("{}: has no camera '{}', which {} names",
                                              options.like.string(),
                                              camera.name,
                                              options.points.string()));
            if (sizes.empty()) {
                nominal.width = found->intrinsics.width;
                nominal.height = found->intrinsics.height;
            }
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

// Doubts about --size, which nothing in the points states. --force goes on.
Expected<void> check_size(const WandCommand& options,
                          const LightPoints& points,
                          const std::optional<PreviousRig>& previous) {
    if (!options.size || options.finish.force) return {};
    const auto [width, height] = *options.size;
    Eigen::Vector2d lowest = Eigen::Vector2d::Constant(1e9);
    Eigen::Vector2d highest = Eigen::Vector2d::Zero();
    std::size_t num_points = 0;
    for (const LightCamera& camera : points) {
        num_points += camera.points.size();
        for (const LightPoint& point : camera.points) {
            lowest = lowest.cwiseMin(point.px);
            highest = highest.cwiseMax(point.px);
        }
        const auto* const before = previous ? find_camera(previous->rig, camera.name) : nullptr;
        if (before == nullptr ||
            (before->intrinsics.width == width && before->intrinsics.height == height))
            continue;
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("--size {}x{}: in {} the pictures of '{}' have {}x{} px: say that, or "
                        "--like {}; if they have another size now, --force",
                        width,
                        height,
                        previous->file.string(),
                        camera.name,
                        before->intrinsics.width,
                        before->intrinsics.height,
                        previous->file.string()));
    }
    const Eigen::Array2d size(width, height);
    const bool is_corner =
        (lowest.array() < kBorder * size).all() && (highest.array() < (1.0 - kBorder) * size).all();
    if (num_points < kManyPoints || !is_corner) return {};
    return make_error(ErrorKind::kConfiguration,
                      fmt::format("--size {}x{}: no light of any camera is right of x = {:.0f} or "
                                  "below y = {:.0f}: are the pictures smaller? If they are not, "
                                  "--force",
                                  width,
                                  height,
                                  highest.x(),
                                  highest.y()));
}

// Fills `options.points`, too.
Expected<WandInput> wand_input(WandCommand& options,
                               const Wand& wand,
                               const std::optional<PreviousRig>& previous,
                               std::stop_token stop) {
    WandInput input;
    if (options.points.empty()) {
        options.points = points_file(options.sweep, options.finish.output);
        auto swept = keep_sweep(options.sweep, wand, options.points, options.finish.force, stop);
        if (!swept) return tl::unexpected(swept.error());
        if (!options.rate_hz) options.rate_hz = swept->rate_hz;
        input = {std::move(swept->points), std::move(swept->cameras)};
    } else {
        auto points = load_light_points(options.points);
        if (!points) return tl::unexpected(points.error());
        input.points = std::move(*points);
    }
    if (const std::string twins = same_pictures(input.points); !twins.empty())
        return make_error(ErrorKind::kInvalidData, twins);
    if (auto fits = check_size(options, input.points, previous); !fits)
        return tl::unexpected(fits.error());
    auto nominal = nominal_cameras(options, input.points, input.nominal);
    if (!nominal) return tl::unexpected(nominal.error());
    input.nominal = std::move(*nominal);
    return input;
}

// How the command line names one source of points.
Expected<void> check_source(const WandCommand& options) {
    const bool is_sweep = options.sweep.source.is_asked();
    if (options.points.empty() != is_sweep)
        return make_error(
            ErrorKind::kConfiguration,
            is_sweep ? "--points: the lights come from a file or from pictures, not from both"
                     : "which lights? Give --points FILE.csv, or pictures: --recording DIR, "
                       "--config SITE.toml, or --capture.source cameras");
    if (is_sweep && options.size)
        return make_error(ErrorKind::kConfiguration, "--size: the pictures tell their sizes");
    return {};
}

Expected<void> run_wand(WandCommand& options) {
    if (auto one = check_source(options); !one) return one;
    const auto previous =
        find_previous_rig(options.finish.output, options.finish.frame_of, options.finish.force);
    if (!previous) return tl::unexpected(previous.error());
    Wand wand = default_wand();
    if (!options.wand.empty()) {
        auto loaded = load_wand(options.wand);
        if (!loaded) return tl::unexpected(loaded.error());
        wand = std::move(*loaded);
    }
    std::optional<app::StopOnSignal> on_signal;
    if (options.points.empty()) on_signal.emplace();
    const auto input =
        wand_input(options, wand, *previous, on_signal ? on_signal->token() : std::stop_token());
    if (!input) return tl::unexpected(input.error());
    WandOptions how;
    how.lens = options.has_third ? LensFreedom::kAllAndThird : LensFreedom::kAll;
    how.num_threads = options.threads > 0
                          ? options.threads
                          : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    const auto solution = [&] {
        Progress progress;
        how.report = [&](const std::string& step) { progress.show(step); };
        return solve_wand(wand, input->nominal, input->points, how);
    }();
    if (!solution) return tl::unexpected(solution.error());
    FinishOptions& finish = options.finish;
    finish.command = "calibrate wand";
    finish.source = options.points.string();
    finish.body = "the wand";
    finish.said = options.said;
    finish.said.rate_hz = options.rate_hz.value_or(*previous ? (*previous)->rig.rate_hz : 30.0);
    return finish_calibration(
        *solution, judge_wand(*solution, finish.said.rate_hz), *previous, finish);
}

}  // namespace

void add_wand(CLI::App& app, Action& action) {
    auto options = std::make_shared<WandCommand>();
    CLI::App* command = app.add_subcommand(
        "wand", "makes a rig.toml from the lights of a wand that was swept through the room");
    command->footer(
        "Examples:\n"
        "  calibrate wand --config site.toml --preview -o lab.toml\n"
        "  calibrate wand --recording sweep7 -o lab.toml\n"
        "  calibrate wand --points sweep.csv --size 1280x1024 -o lab.toml\n"
        "  calibrate wand --points sweep.csv --wand wand.toml --like old.toml -o lab.toml\n"
        "The default wand has four lights on a line, at 0, 10, 30 and 60 cm.\n"
        "Exit codes: 0 done, 1 a damaged file or a calibration that is wrong, 2 wrong command line "
        "or file, 3 a file is missing or cannot be written.");
    command
        ->add_option("--points",
                     options->points,
                     "CSV of bright points: camera,instant,light,x_px,y_px; light may be empty")
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
    command
        ->add_option("--rate",
                     options->rate_hz,
                     "instants per second; default: of the pictures, of the rig before, else 30")
        ->check(CLI::Range(0.1, 1000.0));
    command->add_option("--threads", options->threads, "threads; default: one per processor")
        ->check(CLI::Range(1, 256));
    add_up_option(*command, options->said);
    add_distance_options(*command, options->said);
    add_finish_options(*command, options->finish);
    options->sweep.add_to(*command);
    command->callback([options, &action] { action = [options] { return run_wand(*options); }; });
}

}  // namespace atrium::calibrate
