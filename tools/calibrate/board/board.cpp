#include "tools/calibrate/board/board.hpp"

#include "core/config/table_reader.hpp"

#include <fmt/format.h>
#include <opencv2/aruco.hpp>

#include <algorithm>
#include <array>

namespace atrium::calibrate {
namespace {

constexpr int kMostSquares = 40;
constexpr double kLeastSquare_m = 0.002, kMostSquare_m = 2.0;
constexpr std::size_t kMostBoards = 16;

std::string in_mm(double metres) { return fmt::format("{:.4g} mm", 1000.0 * metres); }

void check_sizes(config::TableReader& table, const Board& board) {
    if (board.kind == BoardKind::kChessboard) {
        for (const char* key : {"marker_m", "dictionary", "first_id", "legacy"})
            table.forbid(key, "a chessboard has no markers; is it kind = \"charuco\"?");
        if ((board.columns + board.rows) % 2 == 0)
            table.reject("squares",
                         "must be an even and an odd number for a chessboard: others look the "
                         "same when they are turned by 180 degrees");
        return;
    }
    if (board.marker_m >= board.square_m) {
        table.reject("marker_m",
                     fmt::format("must be less than square_m, {}: a marker stands in a square; "
                                 "the two may be swapped",
                                 board.square_m));
    } else if (board.marker_m < 0.2 * board.square_m) {
        table.reject("marker_m",
                     fmt::format("must be at least a fifth of square_m, {}", board.square_m));
    }
    const std::size_t size = dictionary_size(board.dictionary);
    if (board.first_id + board.num_markers() > size)
        table.reject("first_id",
                     fmt::format("the board has {} markers from {} on; {} has {}",
                                 board.num_markers(),
                                 board.first_id,
                                 board.dictionary,
                                 size));
}

Board read_board(config::TableReader& table) {
    Board board;
    std::string kind = "charuco";
    table.read("kind", kind, {"charuco", "chessboard"});
    board.kind = kind == "charuco" ? BoardKind::kCharuco : BoardKind::kChessboard;
    table.forbid("square_mm", "write square_m, in metres");
    table.forbid("marker_mm", "write marker_m, in metres");
    table.forbid("corners", "write squares = [columns, rows], of all squares");
    std::array<double, 2> squares{0, 0};
    table.require("squares");
    table.read("squares", squares.data(), 2, {3, kMostSquares});
    for (const double number : squares)
        if (number != static_cast<int>(number)) table.reject("squares", "must be whole numbers");
    board.columns = static_cast<int>(squares[0]);
    board.rows = static_cast<int>(squares[1]);
    table.require("square_m");
    table.read("square_m", board.square_m, {kLeastSquare_m, kMostSquare_m});
    table.read("inverted", board.is_inverted);
    if (board.kind == BoardKind::kCharuco) {
        table.require("marker_m");
        table.read("marker_m", board.marker_m, {0.0, kMostSquare_m});
        table.require("dictionary");
        table.read("dictionary", board.dictionary, dictionary_names());
        table.read("first_id", board.first_id, {0, 1023});
        table.read("legacy", board.is_legacy);
    }
    if (squares[0] >= 3 && squares[1] >= 3) check_sizes(table, board);
    return board;
}

// Of two boards, whether a marker could be of both.
bool share_markers(const Board& a, const Board& b) {
    const auto end = [](const Board& board) {
        return board.first_id + static_cast<int>(board.num_markers());
    };
    return a.dictionary == b.dictionary && a.is_inverted == b.is_inverted && a.first_id < end(b) &&
           b.first_id < end(a);
}

struct Named {
    const char* name;
    int number;
};
constexpr std::array kDictionaries{Named{"DICT_4X4_50", cv::aruco::DICT_4X4_50},
                                   Named{"DICT_4X4_100", cv::aruco::DICT_4X4_100},
                                   Named{"DICT_4X4_250", cv::aruco::DICT_4X4_250},
                                   Named{"DICT_4X4_1000", cv::aruco::DICT_4X4_1000},
                                   Named{"DICT_5X5_50", cv::aruco::DICT_5X5_50},
                                   Named{"DICT_5X5_100", cv::aruco::DICT_5X5_100},
                                   Named{"DICT_5X5_250", cv::aruco::DICT_5X5_250},
                                   Named{"DICT_5X5_1000", cv::aruco::DICT_5X5_1000},
                                   Named{"DICT_6X6_50", cv::aruco::DICT_6X6_50},
                                   Named{"DICT_6X6_100", cv::aruco::DICT_6X6_100},
                                   Named{"DICT_6X6_250", cv::aruco::DICT_6X6_250},
                                   Named{"DICT_6X6_1000", cv::aruco::DICT_6X6_1000},
                                   Named{"DICT_7X7_50", cv::aruco::DICT_7X7_50},
                                   Named{"DICT_7X7_100", cv::aruco::DICT_7X7_100},
                                   Named{"DICT_7X7_250", cv::aruco::DICT_7X7_250},
                                   Named{"DICT_7X7_1000", cv::aruco::DICT_7X7_1000},
                                   Named{"DICT_ARUCO_ORIGINAL", cv::aruco::DICT_ARUCO_ORIGINAL},
                                   Named{"DICT_APRILTAG_16h5", cv::aruco::DICT_APRILTAG_16h5},
                                   Named{"DICT_APRILTAG_25h9", cv::aruco::DICT_APRILTAG_25h9},
                                   Named{"DICT_APRILTAG_36h10", cv::aruco::DICT_APRILTAG_36h10},
                                   Named{"DICT_APRILTAG_36h11", cv::aruco::DICT_APRILTAG_36h11}};

Expected<std::vector<Board>> read_boards(config::TableReader& reader, const std::string& name) {
    std::vector<Board> boards;
    for (config::TableReader& table : reader.tables("board")) {
        boards.push_back(read_board(table));
        for (std::size_t i = 0; i + 1 < boards.size(); ++i) {
            if (boards[i].kind == BoardKind::kChessboard ||
                boards.back().kind == BoardKind::kChessboard)
                table.reject("kind", "chessboards look alike: only ChArUco boards may be several");
            else if (share_markers(boards[i], boards.back()))
                table.reject("first_id",
                             fmt::format("its markers are also those of board {}; give each board "
                                         "markers of its own",
                                         i + 1));
        }
    }
    if (const auto done = reader.finish(); !done) return tl::unexpected(done.error());
    if (boards.empty() || boards.size() > kMostBoards)
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("{}: has {} [[board]]; must have 1 to {}; `calibrate print-board` writes "
                        "such a file",
                        name,
                        boards.size(),
                        kMostBoards));
    return boards;
}

}  // namespace

std::size_t Board::num_markers() const {
    if (kind == BoardKind::kChessboard) return 0;
    const int all = columns * rows;
    return static_cast<std::size_t>(is_black(0, 0) ? all / 2 : (all + 1) / 2);
}

Eigen::Vector3d Board::corner_m(std::size_t corner) const {
    const auto per_row = static_cast<std::size_t>(columns - 1);
    const auto row = static_cast<int>(corner / per_row);
    return {square_m * static_cast<double>(corner % per_row + 1), square_m * (rows - row - 1), 0.0};
}

bool Board::is_black(int column, int row) const {
    const bool is_first_white = is_legacy && rows % 2 == 0;
    return ((column + row) % 2 == 0) != is_first_white;
}

Eigen::Vector2i Board::square_of_marker(std::size_t marker) const {
    std::size_t num = 0;
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column)
            if (!is_black(column, row) && num++ == marker) return {column, row};
    return {-1, -1};
}

std::string Board::text() const {
    std::string words = fmt::format("a {}{} of {} columns and {} rows of squares of {}",
                                    is_inverted ? "inverted " : "",
                                    kind == BoardKind::kCharuco ? "ChArUco board" : "chessboard",
                                    columns,
                                    rows,
                                    in_mm(square_m));
    if (kind == BoardKind::kCharuco)
        words += fmt::format(", markers {} to {} of {}, {} wide",
                             first_id,
                             first_id + static_cast<int>(num_markers()) - 1,
                             dictionary,
                             in_mm(marker_m));
    return words;
}

std::string Board::toml() const {
    std::string lines = fmt::format(
        "[[board]]\nkind = \"{}\"\nsquares = [{}, {}]  # columns, rows\nsquare_m = {}\n",
        kind == BoardKind::kCharuco ? "charuco" : "chessboard",
        columns,
        rows,
        square_m);
    if (kind == BoardKind::kCharuco)
        lines += fmt::format(
            "marker_m = {}\ndictionary = \"{}\"\nfirst_id = {}\n", marker_m, dictionary, first_id);
    if (is_inverted) lines += "inverted = true\n";
    if (is_legacy) lines += "legacy = true\n";
    return lines;
}

const std::vector<std::string>& dictionary_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const Named& named : kDictionaries) all.emplace_back(named.name);
        return all;
    }();
    return names;
}

std::optional<int> dictionary_number(const std::string& name) {
    for (const Named& named : kDictionaries)
        if (name == named.name) return named.number;
    return std::nullopt;
}

std::size_t dictionary_size(const std::string& name) {
    const auto number = dictionary_number(name);
    if (!number) return 0;
    return static_cast<std::size_t>(cv::aruco::getPredefinedDictionary(*number)->bytesList.rows);
}

Expected<std::vector<Board>> load_boards(const std::filesystem::path& file) {
    auto reader = config::TableReader::load(file);
    if (!reader) return tl::unexpected(reader.error());
    return read_boards(*reader, file.string());
}

Expected<std::vector<Board>> parse_boards(const std::string& toml, const std::string& name) {
    auto reader = config::TableReader::parse(toml, name);
    if (!reader) return tl::unexpected(reader.error());
    return read_boards(*reader, name);
}

}  // namespace atrium::calibrate
