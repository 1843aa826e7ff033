#include "core/app/program.hpp"
#include "core/base/thread_pool.hpp"
#include "tools/calibrate/board/film_boards.hpp"
#include "tools/calibrate/board/judge_board.hpp"
#include "tools/calibrate/board/solve_board.hpp"
#include "tools/calibrate/finish_calibration.hpp"
#include "tools/calibrate/frame_options.hpp"
#include "tools/calibrate/progress.hpp"
#include "tools/calibrate/subcommands.hpp"
#include "tools/calibrate/sweep/watch_boards.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;

struct BoardCommand {
    fs::path folder;  // empty: live cameras
    SourceOptions source;
    fs::path board;
    std::vector<std::string> cameras;
    std::optional<std::size_t> most_instants;
    std::optional<std::size_t> num_places;
    bool has_third = false;
    bool has_rate = false;
    int threads = 0;  // 0: one per processor
    FinishOptions finish;
    Said said;
};

std::string source_name(const BoardCommand& options) {
    return options.folder.empty() ? "live cameras" : options.folder.string();
}

Expected<BoardFilm> film_of(BoardCommand& options,
                            const std::vector<Board>& boards,
                            int num_threads) {
    if (options.folder.empty()) {
        if (auto resolved = options.source.resolve(); !resolved)
            return tl::unexpected(resolved.error());
        const app::StopOnSignal on_signal;
        return watch_boards(
            options.source,
            boards,
            options.num_places ? BoardNeeds::of_places(*options.num_places) : BoardNeeds{},
            on_signal.token());
    }
    Progress progress;
    FilmOptions filming;
    filming.cameras = options.cameras;
    filming.most_instants = options.most_instants.value_or(filming.most_instants);
    filming.progress = [&](std::size_t done, std::size_t all) {
        progress.show(fmt::format("looking for boards: {} of {} pictures", done, all));
    };
    ThreadPool pool(static_cast<std::size_t>(num_threads));
    return film_boards(options.folder, boards, filming, pool);
}

// The command line names one source of pictures.
Expected<void> check_source(const BoardCommand& options) {
    const auto wrong = [](std::string text) -> Expected<void> {
        return make_error(ErrorKind::kConfiguration, std::move(text));
    };
    const bool is_live = options.source.is_asked();
    if (!is_live && options.folder.empty())
        return wrong(
            "which pictures? Give a recording, or live cameras: --config SITE.toml, or "
            "--capture.source cameras");
    if (is_live && !options.folder.empty())
        return wrong(
            fmt::format("{}: the pictures come from a folder or from live cameras, not from both",
                        options.folder.string()));
    if (is_live && (!options.cameras.empty() || options.most_instants))
        return wrong(
            "--cameras and --instants choose from a recording; of live cameras all take part, "
            "until each has seen enough (--places)");
    if (!is_live && options.num_places)
        return wrong("--places: tells when live cameras have seen enough");
    return {};
}

Expected<void> run_board(BoardCommand& options) {
    if (auto one = check_source(options); !one) return one;
    const auto previous =
        find_previous_rig(options.finish.output, options.finish.frame_of, options.finish.force);
    if (!previous) return tl::unexpected(previous.error());
    std::vector<Board> boards{Board{}};
    if (!options.board.empty()) {
        auto loaded = load_boards(options.board);
        if (!loaded) return tl::unexpected(loaded.error());
        boards = std::move(*loaded);
    }
    const int num_threads =
        options.threads > 0 ? options.threads
                            : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    BoardOptions how;
    how.lens = options.has_third ? LensFreedom::kAllAndThird : LensFreedom::kAll;
    how.num_threads = num_threads;
    const auto film = film_of(options, boards, num_threads);
    if (!film) return tl::unexpected(film.error());
    if (film->points.size() < 2)
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}: has pictures of one camera; a rig has two or more",
                                      source_name(options)));
    if (const std::string twins = same_board_pictures(film->points); !twins.empty())
        return make_error(ErrorKind::kInvalidData, twins);
    const auto solution = [&] {
        Progress progress;
        how.report = [&](const std::string& step) { progress.show(step); };
        return solve_board(boards, film->points, how);
    }();
    if (!solution) return tl::unexpected(solution.error());
    const double rate_hz = !options.has_rate && film->rate_hz > 0.0
                               ? film->rate_hz
                               : options.said.rate_hz / static_cast<double>(film->step);
    options.said.rate_hz = rate_hz * static_cast<double>(film->step);
    Verdict verdict = judge_board(*solution, rate_hz);
    verdict.checks.insert(verdict.checks.begin(), film->checks.begin(), film->checks.end());
    FinishOptions& finish = options.finish;
    finish.command = "calibrate board";
    finish.source = fmt::format("{}, with {}", source_name(options), boards.front().text());
    finish.body = "the board";
    finish.said = options.said;
    return finish_calibration(solution->rig, std::move(verdict), *previous, finish);
}

}  // namespace

void add_board(CLI::App& app, Action& action) {
    auto options = std::make_shared<BoardCommand>();
    CLI::App* command = app.add_subcommand(
        "board",
        "makes a rig.toml from pictures of a calibration board that was shown to all cameras");
    command->footer(
        "Examples:\n"
        "  calibrate board --config site.toml --preview -o lab.toml\n"
        "  calibrate board take1 -o lab.toml\n"
        "  calibrate board take1 --board board.toml --k3 -o lab.toml\n"
        "The default board is the one that `calibrate print-board` makes without options.\n"
        "Exit codes: 0 done, 1 a damaged file or a calibration that is wrong, 2 wrong command line "
        "or file, 3 a file is missing or cannot be written.");
    command
        ->add_option("folder",
                     options->folder,
                     "recording, or folder with a video or a folder of pictures for each camera; "
                     "live cameras need none")
        ->type_name("DIR");
    command
        ->add_option("--board",
                     options->board,
                     "TOML of the board or boards, as `calibrate print-board` writes it")
        ->type_name("FILE");
    command
        ->add_option("--cameras",
                     options->cameras,
                     "names of the cameras, which their videos or folders have; default: all that "
                     "are found")
        ->type_name("NAME,...")
        ->delimiter(',')
        ->allow_extra_args(false);
    command
        ->add_option("--instants",
                     options->most_instants,
                     "look at this many instants at most, spread over the recording; default: 300")
        ->check(CLI::Range(10, 100000));
    command->add_flag("--k3", options->has_third, "also adjust the distortion k3: for wide lenses");
    command
        ->add_option_function<double>(
            "--rate",
            [options](double rate_hz) {
                options->said.rate_hz = rate_hz;
                options->has_rate = true;
            },
            "pictures per second; default: of the videos, else 30")
        ->check(CLI::Range(0.1, 1000.0));
    command->add_option("--threads", options->threads, "threads; default: one per processor")
        ->check(CLI::Range(1, 256));
    add_up_option(*command, options->said);
    add_distance_options(*command, options->said);
    add_finish_options(*command, options->finish);
    command
        ->add_option("--places",
                     options->num_places,
                     "places at which each live camera must see the board, a third of them tilted; "
                     "default: 25")
        ->check(CLI::Range(6, 1000))
        ->group(kPicturesGroup);
    options->source.add_to(*command, "boards");
    command->callback([options, &action] { action = [options] { return run_board(*options); }; });
}

}  // namespace atrium::calibrate
