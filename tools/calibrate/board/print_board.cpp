#include "tools/calibrate/board/print_board.hpp"

#include <fmt/format.h>
#include <opencv2/aruco.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace atrium::calibrate {
namespace {

constexpr double kMargin_m = 0.010;
constexpr double kFoot_m = 0.022;  // below the board, for ruler and words
constexpr double kRuler_m = 0.1;
constexpr double kLine_m = 0.0042;  // from one line of words to the next
constexpr double kPointsPerMetre = 72.0 / 0.0254;
constexpr double kStep_m = 0.004;

struct Paper {
    const char* name;
    double width_m, height_m;
};
constexpr std::array kPapers{Paper{"a4", 0.210, 0.297},
                             Paper{"a3", 0.297, 0.420},
                             Paper{"a2", 0.420, 0.594},
                             Paper{"a1", 0.594, 0.841},
                             Paper{"a0", 0.841, 1.189},
                             Paper{"letter", 0.2159, 0.2794},
                             Paper{"tabloid", 0.2794, 0.4318},
                             Paper{"fit", 0.0, 0.0}};

const Paper* paper_named(const std::string& name) {
    const auto found =
        std::ranges::find_if(kPapers, [&](const Paper& paper) { return name == paper.name; });
    return found == kPapers.end() ? nullptr : &*found;
}

void add_marker(const Board& board, std::size_t marker, std::vector<PrintedRect>& rects) {
    const Eigen::Vector2i square = board.square_of_marker(marker);
    const auto dictionary = cv::aruco::getPredefinedDictionary(
        dictionary_number(board.dictionary).value_or(cv::aruco::DICT_4X4_50));
    const int cells = dictionary->markerSize + 2;
    cv::Mat bits;
    dictionary->drawMarker(board.first_id + static_cast<int>(marker), cells, bits, 1);
    const double cell = board.marker_m / cells;
    const double gap = 0.5 * (board.square_m - board.marker_m);
    const double left = board.square_m * square.x() + gap;
    const double top = board.square_m * (board.rows - square.y()) - gap;
    for (int row = 0; row < cells; ++row) {
        for (int column = 0; column < cells;) {
            int end = column;
            while (end < cells && bits.at<std::uint8_t>(row, end) == 0) ++end;
            if (end > column)
                rects.push_back(
                    {left + cell * column, top - cell * (row + 1), cell * (end - column), cell});
            column = end + 1;
        }
    }
}

double board_width_m(const Board& board) { return board.square_m * board.columns; }
double board_height_m(const Board& board) { return board.square_m * board.rows; }

std::vector<PrintedRect> ruler_rects(const BoardSheet& sheet) {
    const double left = sheet.board_left_m, y = sheet.board_bottom_m - 0.007;
    std::vector<PrintedRect> rects{{left, y, kRuler_m, 0.0003}};
    for (int i = 0; i <= 10; ++i) {
        const double tick = i % 10 == 0 ? 0.004 : i % 5 == 0 ? 0.003 : 0.002;
        // the ends of the line are those of the ruler
        const double at = i == 0    ? left
                          : i == 10 ? left + kRuler_m - 0.0003
                                    : left + 0.01 * i - 0.00015;
        rects.push_back({at, y, 0.0003, tick});
    }
    return rects;
}

std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) {
        if (c == '(' || c == ')' || c == '\\') result += '\\';
        result += c;
    }
    return result;
}

}  // namespace

std::vector<PrintedRect> printed_rects(const Board& board) {
    std::vector<PrintedRect> rects;
    for (int row = 0; row < board.rows; ++row)
        for (int column = 0; column < board.columns; ++column)
            if (board.is_black(column, row))
                rects.push_back({board.square_m * column,
                                 board.square_m * (board.rows - row - 1),
                                 board.square_m,
                                 board.square_m});
    for (std::size_t marker = 0; marker < board.num_markers(); ++marker)
        add_marker(board, marker, rects);
    return rects;
}

const std::vector<std::string>& paper_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const Paper& paper : kPapers) all.emplace_back(paper.name);
        return all;
    }();
    return names;
}

double widest_square_m(const std::string& name, int columns, int rows) {
    const Paper* paper = paper_named(name);
    if (paper == nullptr || paper->width_m == 0.0) return 0.0;
    double widest = 0.0;
    for (const bool is_across : {false, true}) {
        const double width = (is_across ? paper->height_m : paper->width_m) - 2.0 * kMargin_m;
        const double height =
            (is_across ? paper->width_m : paper->height_m) - kMargin_m - kMargin_m - kFoot_m;
        const double square = std::min(width / columns, height / rows);
        widest = std::max(widest, kStep_m * std::floor(square / kStep_m + 1e-9));
    }
    return widest;
}

Expected<BoardSheet> lay_out(const Board& board, const std::string& name) {
    const Paper* paper = paper_named(name);
    const double width = board_width_m(board), height = board_height_m(board);
    // an inverted board needs its dark border on the page
    const double border = board.is_inverted ? 0.25 * board.square_m : 0.0;
    BoardSheet sheet;
    sheet.board = board;
    const double least_width = std::max(width + 2.0 * border, kRuler_m) + 2.0 * kMargin_m;
    const double least_height = height + 2.0 * border + 2.0 * kMargin_m + kFoot_m;
    if (paper == nullptr || paper->width_m == 0.0) {
        sheet.width_m = least_width;
        sheet.height_m = least_height;
    } else {
        constexpr double kRounding_m = 1e-9;
        const bool fits_upright = least_width <= paper->width_m + kRounding_m &&
                                  least_height <= paper->height_m + kRounding_m;
        const bool fits_across = least_width <= paper->height_m + kRounding_m &&
                                 least_height <= paper->width_m + kRounding_m;
        if (!fits_upright && !fits_across)
            return make_error(
                ErrorKind::kConfiguration,
                fmt::format("a board of {:.0f} x {:.0f} mm does not fit {} with a margin of 10 mm "
                            "and a ruler: give --square-mm {:.0f} or less, another --paper, or "
                            "--paper fit for a page of its size",
                            1000.0 * width,
                            1000.0 * height,
                            name,
                            1000.0 * widest_square_m(name, board.columns, board.rows)));
        sheet.width_m = fits_upright ? paper->width_m : paper->height_m;
        sheet.height_m = fits_upright ? paper->height_m : paper->width_m;
    }
    sheet.board_left_m = 0.5 * (sheet.width_m - width);
    sheet.board_bottom_m = kMargin_m + kFoot_m + border + 0.5 * (sheet.height_m - least_height);
    sheet.words = {"The line is 100 mm long. Print at 100 %, without fitting to the page.",
                   "Atrium: " + board.text() + ".",
                   "Its origin is the corner of the pattern at the bottom left; X right, Y up."};
    return sheet;
}

std::string pdf_of(const BoardSheet& sheet) {
    std::string content;
    auto out = std::back_inserter(content);
    const auto pt = [](double metres) { return metres * kPointsPerMetre; };
    const auto rect = [&](const PrintedRect& r, double left, double bottom) {
        fmt::format_to(out,
                       "{:.6f} {:.6f} {:.6f} {:.6f} re\n",
                       pt(left + r.left),
                       pt(bottom + r.bottom),
                       pt(r.width),
                       pt(r.height));
    };
    const Board& board = sheet.board;
    if (board.is_inverted) {
        const double border = 0.25 * board.square_m;
        content += "0 g\n";
        rect({-border,
              -border,
              board_width_m(board) + 2 * border,
              board_height_m(board) + 2 * border},
             sheet.board_left_m,
             sheet.board_bottom_m);
        content += "f\n1 g\n";
    } else {
        content += "0 g\n";
    }
    // one path: no seams between cells that touch
    for (const PrintedRect& r : printed_rects(board))
        rect(r, sheet.board_left_m, sheet.board_bottom_m);
    content += "f\n0 g\n";
    for (PrintedRect r : ruler_rects(sheet)) {
        if (board.is_inverted) r.bottom -= 0.25 * board.square_m;
        rect(r, 0.0, 0.0);
    }
    content += "f\nBT /F 8 Tf\n";
    double y = sheet.board_bottom_m - 0.0115 - (board.is_inverted ? 0.25 * board.square_m : 0.0);
    for (const std::string& line : sheet.words) {
        fmt::format_to(out,
                       "1 0 0 1 {:.3f} {:.3f} Tm ({}) Tj\n",
                       pt(sheet.board_left_m),
                       pt(y),
                       escaped(line));
        y -= kLine_m;
    }
    content += "ET\n";

    std::string pdf = "%PDF-1.4\n";
    std::vector<std::size_t> places;
    const auto object = [&](const std::string& text) {
        places.push_back(pdf.size());
        pdf += fmt::format("{} 0 obj\n{}\nendobj\n", places.size(), text);
    };
    object("<< /Type /Catalog /Pages 2 0 R /ViewerPreferences << /PrintScaling /None >> >>");
    object("<< /Type /Pages /Kids [3 0 R] /Count 1 >>");
    object(
        fmt::format("<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {:.6f} {:.6f}] /Contents 4 0 R "
                    "/Resources << /Font << /F 5 0 R >> >> >>",
                    pt(sheet.width_m),
                    pt(sheet.height_m)));
    object(fmt::format("<< /Length {} >>\nstream\n{}endstream", content.size(), content));
    object("<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>");
    const std::size_t table = pdf.size();
    pdf += fmt::format("xref\n0 {}\n0000000000 65535 f \n", places.size() + 1);
    for (const std::size_t place : places) pdf += fmt::format("{:010} 00000 n \n", place);
    pdf += fmt::format(
        "trailer\n<< /Size {} /Root 1 0 R >>\nstartxref\n{}\n%%EOF\n", places.size() + 1, table);
    return pdf;
}

}  // namespace atrium::calibrate
