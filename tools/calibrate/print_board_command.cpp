#include "tools/calibrate/board/board.hpp"
#include "tools/calibrate/board/print_board.hpp"
#include "tools/calibrate/formats/rig_file.hpp"
#include "tools/calibrate/frame_options.hpp"
#include "tools/calibrate/subcommands.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <memory>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;

struct PrintCommand {
    std::array<int, 2> squares{5, 7};
    double square_mm = 0.0, marker_mm = 0.0;  // 0: as wide as fits; three quarters of a square
    std::string dictionary = "DICT_4X4_50";
    int first_id = 0;
    bool is_chessboard = false;
    bool is_inverted = false;
    std::string paper = "a4";
    double dpi = 300.0;
    bool force = false;
    fs::path output;
};

std::array<int, 2> parse_squares(const std::string& text) {
    const std::size_t x = text.find('x');
    const auto columns = parse_number(text.substr(0, x), 3, 40);
    const auto rows = parse_number(x == std::string::npos ? "" : text.substr(x + 1), 3, 40);
    if (!columns || !rows || *columns != static_cast<int>(*columns) ||
        *rows != static_cast<int>(*rows))
        throw CLI::ValidationError("--squares",
                                   "must be COLUMNSxROWS, 3 to 40 squares, got " + text);
    return {static_cast<int>(*columns), static_cast<int>(*rows)};
}

// The description, checked as every file of a board is.
Expected<Board> described(const PrintCommand& options) {
    Board board;
    board.kind = options.is_chessboard ? BoardKind::kChessboard : BoardKind::kCharuco;
    board.columns = options.squares[0];
    board.rows = options.squares[1];
    board.dictionary = options.dictionary;
    board.first_id = options.first_id;
    board.is_inverted = options.is_inverted;
    board.square_m = options.square_mm > 0.0
                         ? options.square_mm / 1000.0
                         : widest_square_m(options.paper, board.columns, board.rows);
    if (board.square_m <= 0.0)
        return make_error(ErrorKind::kConfiguration,
                          options.paper == "fit"
                              ? "--paper fit makes the page as large as the board: give --square-mm"
                              : "so many squares do not fit the paper: give fewer, or a larger "
                                "--paper");
    board.marker_m = options.marker_mm > 0.0 ? options.marker_mm / 1000.0 : 0.75 * board.square_m;
    const auto checked = parse_boards(board.toml(), "the board");
    if (!checked) return tl::unexpected(checked.error());
    return board;
}

Expected<void> run_print_board(const PrintCommand& options) {
    const auto board = described(options);
    if (!board) return tl::unexpected(board.error());
    const auto sheet = lay_out(*board, options.paper);
    if (!sheet) return tl::unexpected(sheet.error());
    const auto png = png_of(*sheet, options.dpi);
    if (!png) return tl::unexpected(png.error());
    const auto beside = [&](const char* suffix) {
        fs::path file = options.output;
        return file.replace_extension(suffix);
    };
    const std::array<std::pair<fs::path, std::string>, 3> files{
        {{beside(".pdf"), pdf_of(*sheet)},
         {beside(".png"), *png},
         {beside(".toml"), fmt::format("# {}\n{}", board->text(), board->toml())}}};
    std::error_code failure;
    for (const auto& [file, bytes] : files)
        if (!options.force && fs::exists(file, failure))
            return make_error(ErrorKind::kConfiguration,
                              fmt::format("{}: exists already; give another -o, or --force to "
                                          "replace it",
                                          file.string()));
    fmt::print("{}\n", board->text());
    fmt::print(
        "page: {:.1f} x {:.1f} mm. Print {} at 100 %, then measure its line of 100 mm. If it "
        "is not 100 mm long, measure a row of squares, and write its square_m and marker_m "
        "into {}\n",
        1000.0 * sheet->width_m,
        1000.0 * sheet->height_m,
        files[0].first.string(),
        files[2].first.string());
    for (const auto& [file, bytes] : files) {
        if (const auto written = write_text(file, bytes, options.force); !written) return written;
        fmt::print("wrote {}\n", file.string());
    }
    return {};
}

}  // namespace

void add_print_board(CLI::App& app, Action& action) {
    auto options = std::make_shared<PrintCommand>();
    CLI::App* command = app.add_subcommand(
        "print-board", "makes a calibration board to print, as PDF, PNG and board.toml");
    command->footer(
        "Examples:\n"
        "  calibrate print-board -o board\n"
        "  calibrate print-board --paper a1 --squares 7x9 -o large\n"
        "Without options: the board that `calibrate board` takes without --board.\n"
        "Exit codes: 0 done, 2 wrong command line, 3 a file cannot be written.");
    command
        ->add_option_function<std::string>(
            "--squares",
            [options](const std::string& text) { options->squares = parse_squares(text); },
            "columns and rows of squares; default: 5x7")
        ->type_name("COLUMNSxROWS");
    command
        ->add_option("--square-mm",
                     options->square_mm,
                     "side of a square; default: as wide as the paper has")
        ->check(CLI::Range(2.0, 2000.0));
    command
        ->add_option(
            "--marker-mm", options->marker_mm, "side of a marker; default: 3/4 of a square")
        ->check(CLI::Range(1.0, 2000.0));
    command->add_option("--dictionary", options->dictionary, "of the markers, as OpenCV names it")
        ->check(CLI::IsMember(dictionary_names()))
        ->capture_default_str();
    command
        ->add_option("--first-id",
                     options->first_id,
                     "number of the first marker: give each of several boards markers of its own")
        ->check(CLI::Range(0, 1023))
        ->capture_default_str();
    command->add_flag("--chessboard", options->is_chessboard, "without markers");
    command->add_flag("--inverted", options->is_inverted, "white where others are black");
    command->add_option("--paper", options->paper, "size of the page")
        ->check(CLI::IsMember(paper_names()))
        ->capture_default_str();
    command->add_option("--dpi", options->dpi, "pixels per inch of the PNG")
        ->check(CLI::Range(50.0, 2400.0))
        ->capture_default_str();
    command
        ->add_option(
            "-o,--output", options->output, "name of the files without .pdf, .png and .toml")
        ->required();
    command->add_flag("--force", options->force, "replace the files");
    command->callback(
        [options, &action] { action = [options] { return run_print_board(*options); }; });
}

}  // namespace atrium::calibrate
