#pragma once

#include "tools/calibrate/board/board.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// A rectangle on a page or board [m]; +Y up.
struct PrintedRect {
    double left = 0.0, bottom = 0.0, width = 0.0, height = 0.0;
};

/// The dark parts of a board in its frame: squares, and cells of markers. Of an inverted board, the
/// light ones: all else of its width and height, and of a border around it, is dark.
std::vector<PrintedRect> printed_rects(const Board& board);

/// A page with a board, a ruler and a description.
struct BoardSheet {
    Board board;
    double width_m = 0.0, height_m = 0.0;
    double board_left_m = 0.0, board_bottom_m = 0.0;  // of the board's origin on the page
    std::vector<std::string> words;                   // lines below the board
};

/// Names of papers: "a4", "a3", ..., "letter", and "fit" for a page as large as the board needs.
const std::vector<std::string>& paper_names();

/// The widest square, in whole multiples of 4 mm, with which a board of so many columns and rows
/// fits the paper [m]; 0 if none does, or for "fit".
double widest_square_m(const std::string& paper, int columns, int rows);

/// Lays a board on a page, upright or across. Error kConfiguration if it does not fit.
Expected<BoardSheet> lay_out(const Board& board, const std::string& paper);

/// A PDF of one page in true size: 1 pt is 1/72 in.
std::string pdf_of(const BoardSheet& sheet);

/// The page as a grey PNG with this many pixels per inch, which the file also says. Error
/// kConfiguration if it had more than 400 megapixels.
Expected<std::string> png_of(const BoardSheet& sheet, double dpi);

}  // namespace atrium::calibrate
