// Boards in files and pictures: their description, their print, and their detection.
#include "filmed_room.hpp"
#include "tools/calibrate/board/film_boards.hpp"
#include "tools/calibrate/board/print_board.hpp"
#include "tools/calibrate/board/recognise.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>

namespace atrium::calibrate {
namespace {

using calibrate_test::large_board;
using calibrate_test::photograph;
using testing::ElementsAre;
using testing::HasSubstr;

std::string error_of(const std::string& toml) {
    const auto boards = parse_boards(toml, "b.toml");
    return boards ? "" : boards.error().message;
}

TEST(BoardFiles, ReadWhatTheyWrite) {
    Board board = large_board();
    board.first_id = 4;
    board.is_inverted = board.is_legacy = true;
    const auto boards = parse_boards(board.toml(), "b.toml");
    ASSERT_TRUE(boards) << boards.error().message;
    EXPECT_EQ(boards->front().toml(), board.toml());
    EXPECT_EQ(boards->front().text(), board.text());
}

TEST(BoardFiles, NameWhatIsWrong) {
    const std::string good =
        "[[board]]\nsquares = [5, 7]\nsquare_m = 0.04\nmarker_m = 0.03\ndictionary = "
        "\"DICT_4X4_50\"\n";
    EXPECT_EQ(error_of(good), "");
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        return error_of(text.replace(text.find(from), from.size(), to));
    };
    EXPECT_THAT(with("0.03", "0.05"), HasSubstr("the two may be swapped"));
    EXPECT_THAT(with("DICT_4X4_50", "DICT_4X4"), HasSubstr("b.toml:5"));
    EXPECT_THAT(with("[5, 7]", "[15, 17]"), HasSubstr("DICT_4X4_50 has 50"));
    EXPECT_THAT(with("squares", "corners"), HasSubstr("write squares = [columns, rows]"));
    EXPECT_THAT(with("square_m = 0.04", "square_mm = 40"), HasSubstr("write square_m, in metres"));
    EXPECT_THAT(error_of(good + good), HasSubstr("its markers are also those of board 1"));
    EXPECT_THAT(error_of("[[board]]\nkind = \"chessboard\"\nsquares = [6, 8]\nsquare_m = 0.04\n"),
                HasSubstr("look the same when they are turned"));
    EXPECT_THAT(error_of(""), HasSubstr("has 0 [[board]]"));
}

// The page and each rectangle in points, to a thousandth.
TEST(PrintedBoards, HaveTheirTrueSize) {
    for (const char* paper : {"a4", "a3", "letter", "fit"}) {
        const Board board = large_board();
        Board small = board;
        if (std::string(paper) != "fit") {
            small.square_m = widest_square_m(paper, board.columns, board.rows);
            small.marker_m = 0.75 * small.square_m;
        }
        const auto sheet = lay_out(small, paper);
        ASSERT_TRUE(sheet) << sheet.error().message;
        const std::string pdf = pdf_of(*sheet);
        double width = 0.0, height = 0.0;
        ASSERT_EQ(
            std::sscanf(
                pdf.c_str() + pdf.find("/MediaBox"), "/MediaBox [0 0 %lf %lf]", &width, &height),
            2);
        EXPECT_NEAR(width, sheet->width_m / 0.0254 * 72.0, 1e-3);
        EXPECT_NEAR(height, sheet->height_m / 0.0254 * 72.0, 1e-3);
        // the first square at the top left
        double left = 0.0, bottom = 0.0, side = 0.0, other = 0.0;
        ASSERT_EQ(std::sscanf(pdf.c_str() + pdf.find("0 g\n"),
                              "0 g\n%lf %lf %lf %lf re",
                              &left,
                              &bottom,
                              &side,
                              &other),
                  4);
        EXPECT_NEAR(side, small.square_m / 0.0254 * 72.0, 1e-3);
        EXPECT_EQ(side, other);
        EXPECT_NEAR(left, sheet->board_left_m / 0.0254 * 72.0, 1e-3);
        EXPECT_GT(left, 10.0 / 25.4 * 72.0 - 1e-3) << "printers leave a margin";
        EXPECT_THAT(pdf, HasSubstr("(The line is 100 mm long."));
        // readers find objects by these places
        const std::size_t table =
            std::strtoul(pdf.c_str() + pdf.find("startxref\n") + 10, nullptr, 10);
        EXPECT_EQ(pdf.substr(table, 4), "xref");
        const std::size_t first =
            std::strtoul(pdf.c_str() + pdf.find("65535 f \n") + 9, nullptr, 10);
        EXPECT_EQ(pdf.substr(first, 7), "1 0 obj");
    }
    EXPECT_THAT(lay_out(large_board(), "a4").error().message,
                HasSubstr("give --square-mm 36 or less"));
}

TEST(PrintedBoards, AreTheDefaultBoardOnA4) {
    const Board board;
    EXPECT_DOUBLE_EQ(widest_square_m("a4", board.columns, board.rows), board.square_m);
    EXPECT_DOUBLE_EQ(board.marker_m, 0.75 * board.square_m);
}

class PrintedKinds : public testing::TestWithParam<int> {};

// Each kind of board, from its PNG: all corners, at the pixels to which they are rounded.
TEST_P(PrintedKinds, AreDetectedWithAllCorners) {
    Board board;
    const int kind = GetParam();
    if (kind == 1) board.is_inverted = true;
    if (kind == 2) board.columns = 8, board.rows = 6, board.is_legacy = true;
    if (kind == 3) board.columns = 6, board.rows = 8, board.first_id = 20;
    if (kind == 4) board.dictionary = "DICT_APRILTAG_36h11";
    if (kind == 5) board.kind = BoardKind::kChessboard, board.columns = 6;
    board.square_m = 0.024;
    board.marker_m = 0.018;
    const auto sheet = lay_out(board, "a4");
    ASSERT_TRUE(sheet) << sheet.error().message;
    constexpr double kDpi = 127.0;  // 5 px per mm
    const auto png = png_of(*sheet, kDpi);
    ASSERT_TRUE(png) << png.error().message;
    EXPECT_THAT(*png, HasSubstr(std::string("pHYs\0\0\x13\x88", 8))) << "5000 px per m";
    const std::string file = testing::TempDir() + "board" + std::to_string(kind) + ".png";
    std::ofstream(file, std::ios::binary) << *png;
    const GrayPicture picture = load_gray(file);
    std::remove(file.c_str());
    ASSERT_FALSE(picture.pixels.empty());
    const Detection found = BoardDetector({board}).detect(picture);
    ASSERT_EQ(found.corners.size(), board.num_corners());
    EXPECT_THAT(found.contradicting, testing::IsEmpty());
    for (const SeenCorner& corner : found.corners) {
        const Eigen::Vector3d at = board.corner_m(corner.corner);
        const Eigen::Vector2d place(
            5000.0 * (sheet->board_left_m + at.x()) - 0.5,
            picture.height - 5000.0 * (sheet->board_bottom_m + at.y()) - 0.5);
        EXPECT_LT((corner.px - place).norm(), 0.6) << corner.corner;  // rounded to pixels
    }
}
INSTANTIATE_TEST_SUITE_P(All, PrintedKinds, testing::Range(0, 6));

geometry::PinholeCamera test_lens() {
    geometry::PinholeCamera lens;
    lens.width = 800;
    lens.height = 600;
    lens.fx = lens.fy = 700.0;
    lens.cx = 401.0;
    lens.cy = 297.0;
    lens.distortion = {-0.2, 0.05, 1e-3, -5e-4, 0.0};
    return lens;
}

geometry::RigidTransform place_of(const Board& board, std::uint32_t seed) {
    std::mt19937 rng(seed);
    std::uniform_real_distribution<double> vary(-1.0, 1.0);
    geometry::RigidTransform pose;
    pose.rotation = Eigen::AngleAxisd(3.14159265 + 0.7 * vary(rng), Eigen::Vector3d::UnitX()) *
                    Eigen::AngleAxisd(0.7 * vary(rng), Eigen::Vector3d::UnitY()) *
                    Eigen::AngleAxisd(3.0 * vary(rng), Eigen::Vector3d::UnitZ());
    pose.translation = Eigen::Vector3d(0.03 * vary(rng), 0.03 * vary(rng), 0.85 + 0.1 * vary(rng)) -
                       pose.rotation * Eigen::Vector3d(0.5 * board.columns * board.square_m,
                                                       0.5 * board.rows * board.square_m,
                                                       0.0);
    return pose;
}

// Rendered with a lens, leaning: where the corners truly are.
TEST(BoardDetectors, FindCornersWhereTheyAre) {
    for (const int kind : {0, 1}) {
        Board board = large_board();
        if (kind == 1) {
            board.kind = BoardKind::kChessboard;
            board.columns = 6;
        }
        const BoardDetector detector({board});
        double sum = 0.0, num = 0.0;
        for (const std::uint32_t seed : {1U, 2U, 3U, 4U}) {
            const auto pose = place_of(board, seed);
            const auto found = detector.detect(photograph(board, test_lens(), pose));
            EXPECT_GT(found.corners.size(), board.num_corners() * 8 / 10) << kind << ' ' << seed;
            for (const SeenCorner& corner : found.corners) {
                const Eigen::Vector2d truth =
                    test_lens().distort(test_lens().project(pose * board.corner_m(corner.corner)));
                EXPECT_LT((corner.px - truth).norm(), 0.5) << kind << ' ' << seed;
                sum += (corner.px - truth).squaredNorm();
                num += 2.0;
            }
        }
        EXPECT_LT(std::sqrt(sum / num), 0.1) << kind;
    }
}

std::string recognised(const Board& shown, const Board& said, bool is_mirrored = false) {
    GrayPicture picture = photograph(shown, test_lens(), place_of(shown, 1));
    if (is_mirrored)
        for (int y = 0; y < picture.height; ++y)
            std::reverse(picture.pixels.begin() + y * picture.width,
                         picture.pixels.begin() + (y + 1) * picture.width);
    return recognise({picture}, {said});
}

TEST(UnknownBoards, AreNamed) {
    const Board board = large_board();
    Board other = board;
    other.dictionary = "DICT_5X5_100";
    EXPECT_THAT(recognised(other, board), HasSubstr("markers of dictionary DICT_5X5_50"));
    other = board;
    other.is_inverted = true;
    EXPECT_THAT(recognised(other, board), HasSubstr("write inverted = true"));
    EXPECT_THAT(recognised(board, other), HasSubstr("write inverted = false"));
    EXPECT_THAT(recognised(board, board, true), HasSubstr("the pictures are mirrored"));
    other = board;
    std::swap(other.columns, other.rows);
    EXPECT_THAT(recognised(board, other),
                HasSubstr("lie as on a board of 5 columns and 7 rows or more, and --board says 7"));
    other = board;
    other.first_id = 30;
    EXPECT_THAT(recognised(board, other), HasSubstr("says first_id = 30"));
    Board chess = board;
    chess.kind = BoardKind::kChessboard;
    chess.columns = 6;
    Board corners = chess;
    corners.columns = 5;
    corners.rows = 6;
    EXPECT_THAT(recognised(chess, corners), HasSubstr("count squares, not the corners"));
    EXPECT_THAT(recognised(board, chess), HasSubstr("write kind = \"charuco\""));
    GrayPicture empty{640, 480, std::vector<std::uint8_t>(640 * 480, 100)};
    EXPECT_THAT(recognise({empty}, {board}), HasSubstr("no markers of any known dictionary"));
}

}  // namespace
}  // namespace atrium::calibrate
