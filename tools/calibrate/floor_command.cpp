#include "core/app/program.hpp"
#include "core/base/thread_pool.hpp"
#include "core/config/rig.hpp"
#include "tools/calibrate/board/film_boards.hpp"
#include "tools/calibrate/calibrated_rig.hpp"
#include "tools/calibrate/floor/find_marks.hpp"
#include "tools/calibrate/floor/floor_frame.hpp"
#include "tools/calibrate/front.hpp"
#include "tools/calibrate/progress.hpp"
#include "tools/calibrate/subcommands.hpp"
#include "tools/calibrate/sweep/sweep.hpp"
#include "tools/calibrate/sweep/watch_boards.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <thread>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kFloorInstants = 20;  // the board lies still

struct FloorCommand {
    fs::path rig;
    fs::path pictures;
    fs::path points;
    SourceOptions source;
    fs::path board;
    std::optional<fs::path> wand;  // empty path: the default one
    double yaw_deg = 0.0;
    double thickness_mm = 0.0;
    std::string front;
    bool force = false;
    fs::path output;
};

Expected<BoardFilm> film_floor(FloorCommand& options,
                               const std::vector<Board>& boards,
                               const config::Rig& rig) {
    if (options.source.is_asked()) {
        if (auto resolved = options.source.resolve(); !resolved)
            return tl::unexpected(resolved.error());
        const app::StopOnSignal on_signal;
        return watch_resting_board(options.source, boards, rig, on_signal.token());
    }
    FilmOptions filming;
    filming.most_instants = kFloorInstants;
    filming.least_views = 0;
    for (const auto& camera : rig.cameras) filming.cameras.push_back(camera.name);
    Progress progress;
    filming.progress = [&](std::size_t done, std::size_t all) {
        progress.show(fmt::format("looking for the board: {} of {} pictures", done, all));
    };
    ThreadPool pool(std::max(1U, std::thread::hardware_concurrency()));
    return film_boards(options.pictures, boards, filming, pool);
}

Expected<FoundMarks> find_by_board(FloorCommand& options, const config::Rig& rig) {
    std::vector<Board> boards{Board{}};
    if (!options.board.empty()) {
        auto loaded = load_boards(options.board);
        if (!loaded) return tl::unexpected(loaded.error());
        boards = std::move(*loaded);
    }
    const auto film = film_floor(options, boards, rig);
    if (!film) return tl::unexpected(film.error());
    return marks_of_board(rig, boards, film->points);
}

Expected<LightPoints> light_points(FloorCommand& options,
                                   const std::optional<Wand>& wand,
                                   const config::Rig& rig) {
    if (!options.points.empty()) return load_light_points(options.points);
    if (auto resolved = options.source.resolve(); !resolved)
        return tl::unexpected(resolved.error());
    const app::StopOnSignal on_signal;
    return watch_resting_wand(options.source, *wand, rig, on_signal.token());
}

Expected<FoundMarks> find_by_lights(FloorCommand& options, const config::Rig& rig) {
    std::optional<Wand> wand;
    if (options.wand) wand = default_wand();
    if (options.wand && !options.wand->empty()) {
        auto loaded = load_wand(*options.wand);
        if (!loaded) return tl::unexpected(loaded.error());
        wand = std::move(*loaded);
    }
    const auto points = light_points(options, wand, rig);
    if (!points) return tl::unexpected(points.error());
    return marks_of_lights(rig, *points, wand);
}

// Says where +X points: marks that lie the wrong way round fit the floor as well.
Expected<void> set_front(const FloorCommand& options, config::Rig& rig, RigReport& report) {
    if (!options.front.empty() && !turn_front_towards(options.front, rig.cameras))
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("--front {}: no camera has this name", options.front));
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const auto& camera : rig.cameras)
        middle += camera.centre_site() / static_cast<double>(rig.cameras.size());
    report.told.push_back(fmt::format(
        "{}; the origin is {:.2f} m from the middle of the cameras{}",
        front_text(front_camera(rig.cameras)),
        std::hypot(middle.x(), middle.y()),
        options.front.empty() ? "; if people face another camera, say --front NAME, and if the "
                                "origin is at the wrong end, lay the marks the other way round"
                              : ""));
    return {};
}

Expected<void> run_floor(FloorCommand& options) {
    const bool is_live = options.source.is_asked();
    if ((options.pictures.empty() ? 0 : 1) + (options.points.empty() ? 0 : 1) + (is_live ? 1 : 0) !=
        1)
        return make_error(ErrorKind::kConfiguration,
                          "give one of: live cameras (--config SITE.toml) that see a board, or "
                          "with --wand a wand, "
                          "lie on the floor, --pictures of a board, or --points of lights");
    if (options.wand && (!options.pictures.empty() || !options.board.empty()))
        return make_error(ErrorKind::kConfiguration,
                          "--wand: goes with live cameras (--config SITE.toml) or with --points; "
                          "--pictures and --board are of a board");
    if (auto free = check_output(options.output, options.force); !free) return free;
    auto rig = config::load_rig(options.rig);
    if (!rig) return tl::unexpected(rig.error());
    const auto found = !options.wand && options.points.empty() ? find_by_board(options, *rig)
                                                               : find_by_lights(options, *rig);
    if (!found) return tl::unexpected(found.error());
    const auto frame =
        floor_frame(found->marks,
                    rig->cameras,
                    {options.yaw_deg * std::numbers::pi / 180.0, options.thickness_mm / 1000.0});
    if (!frame) return tl::unexpected(frame.error());
    RigReport report{fmt::format("{} with the floor of {}, by `calibrate floor`.",
                                 options.rig.string(),
                                 is_live                    ? "live pictures"
                                 : options.pictures.empty() ? options.points.string()
                                                            : options.pictures.string()),
                     found->told,
                     found->checks,
                     found->problems};
    for (auto& camera : rig->cameras)
        camera.camera_from_site = camera.camera_from_site * frame->rig_from_floor;
    if (auto turned = set_front(options, *rig, report); !turned) return turned;
    const auto height = [](const geometry::CalibratedCamera& camera) {
        return camera.centre_site().z();
    };
    const auto [lowest, highest] = std::ranges::minmax_element(rig->cameras, {}, height);
    report.told.push_back(fmt::format("floor: {} marks within {:.1f} mm RMS of a plane",
                                      found->marks.on_floor.size(),
                                      1000.0 * frame->rms_m));
    report.told.push_back(fmt::format(
        "cameras: '{}' is lowest, {:.2f} m above the floor, '{}' highest, {:.2f} m: measure one",
        lowest->name,
        height(*lowest),
        highest->name,
        height(*highest)));
    if (frame->num_below > 0)
        report.checks.push_back(fmt::format(
            "{} of {} cameras would be below the floor", frame->num_below, rig->cameras.size()));
    constexpr double kRough_m = 0.01;
    if (frame->rms_m > kRough_m)
        report.checks.push_back(
            "the marks are centimetres off a plane: is the floor flat, and do "
            "all of them lie on it?");
    if (rig->has_bounds)
        report.checks.push_back(
            "[bounds] of the rig are left out: they were those of another frame");
    rig->bounds_site = {};
    return print_and_write(report, *rig, options.output, options.force);
}

}  // namespace

void add_floor(CLI::App& app, Action& action) {
    auto options = std::make_shared<FloorCommand>();
    CLI::App* command = app.add_subcommand(
        "floor", "gives a rig.toml the frame of its room, from a board or lights on the floor");
    command->footer(
        "Examples:\n"
        "  calibrate floor lab.toml --config site.toml -o lab2.toml\n"
        "  calibrate floor lab.toml --config site.toml --wand -o lab2.toml\n"
        "  calibrate floor lab.toml --pictures floor --board board.toml --thickness-mm 5 -o "
        "lab2.toml\n"
        "  calibrate floor lab.toml --points floor.csv -o lab2.toml\n"
        "  calibrate floor lab.toml --points floor.csv --wand wand.toml --yaw-deg 90 -o lab2.toml\n"
        "The board's origin is the corner of its pattern at the bottom left, with +X to the right. "
        "Lights: 0 is the origin, 1 lies on +X, 2 on the side of +Y.\n"
        "Exit codes: 0 done, 1 a damaged file or a floor that is wrong, 2 wrong command line or "
        "file, 3 a file is missing or cannot be written.");
    command->add_option("rig", options->rig, "rig.toml, or the folder that has one")
        ->required()
        ->type_name("RIG");
    command
        ->add_option("--pictures",
                     options->pictures,
                     "recording or folder with pictures of the cameras in which the board lies on "
                     "the floor")
        ->type_name("DIR");
    command
        ->add_option("--points",
                     options->points,
                     "CSV of lights on the floor: camera,instant,light,x_px,y_px")
        ->type_name("FILE");
    command
        ->add_option("--board", options->board, "TOML of the board; default: that of print-board")
        ->type_name("FILE");
    command
        ->add_option_function<std::string>(
            "--wand",
            [options](const std::string& file) { options->wand = file; },
            "TOML of the wand that lies on the floor, live or in --points; without a value: the "
            "default wand")
        ->expected(0, 1)
        ->type_name("FILE");
    auto* yaw =
        command
            ->add_option("--yaw-deg",
                         options->yaw_deg,
                         "angle of the marks' +X in the room, counter-clockwise seen from above")
            ->check(CLI::Range(-360.0, 360.0));
    command
        ->add_option("--front",
                     options->front,
                     "camera towards which +X points, from the marks' origin: people look along it")
        ->excludes(yaw)
        ->type_name("CAMERA");
    command
        ->add_option("--thickness-mm",
                     options->thickness_mm,
                     "height of the pattern or lights above the floor")
        ->check(CLI::Range(0.0, 2000.0));
    command
        ->add_option(
            "-o,--output", options->output, "rig.toml to write; one that it replaces is kept")
        ->required();
    command->add_flag(
        "--force", options->force, "write in spite of problems, and replace a file that is no rig");
    options->source.add_to(*command, "the board");
    command->callback([options, &action] { action = [options] { return run_floor(*options); }; });
}

}  // namespace atrium::calibrate
