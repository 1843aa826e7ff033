#include "tools/calibrate/board/print_board.hpp"

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace atrium::calibrate {
namespace {

constexpr double kMostPixels = 4e8;
constexpr double kInch_m = 0.0254;

// Of PNG (RFC 2083, section 15).
std::uint32_t crc_of(const std::string& bytes) {
    std::uint32_t crc = 0xffffffffU;
    for (const char c : bytes) {
        crc ^= static_cast<std::uint8_t>(c);
        for (int k = 0; k < 8; ++k) crc = (crc & 1U) != 0 ? 0xedb88320U ^ (crc >> 1U) : crc >> 1U;
    }
    return ~crc;
}

std::string big_endian(std::uint32_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8)
        bytes += static_cast<char>((value >> static_cast<unsigned>(shift)) & 0xffU);
    return bytes;
}

// The chunk that says how large the pixels are, behind the header.
std::string with_size_of_pixels(const std::vector<std::uint8_t>& png, double dpi) {
    constexpr std::size_t kEndOfHeader = 33;
    std::string bytes(png.begin(), png.end());
    const auto per_metre = static_cast<std::uint32_t>(std::lround(dpi / kInch_m));
    const std::string chunk = "pHYs" + big_endian(per_metre) + big_endian(per_metre) + '\1';
    bytes.insert(kEndOfHeader, big_endian(9) + chunk + big_endian(crc_of(chunk)));
    return bytes;
}

}  // namespace

Expected<std::string> png_of(const BoardSheet& sheet, double dpi) {
    const double scale = dpi / kInch_m;  // px per m
    if (sheet.width_m * sheet.height_m * scale * scale > kMostPixels)
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("the picture would have {:.0f} x {:.0f} px: give fewer --dpi, "
                        "or use the PDF, which has any size",
                        sheet.width_m * scale,
                        sheet.height_m * scale));
    const int width = static_cast<int>(std::lround(sheet.width_m * scale));
    const int height = static_cast<int>(std::lround(sheet.height_m * scale));
    cv::Mat page(height, width, CV_8U, cv::Scalar(255));
    // Pixels whose middle is in a rectangle: cells that touch have no seam.
    const auto fill = [&](const PrintedRect& r, std::uint8_t value) {
        const auto column = [&](double x_m) {
            return std::clamp(
                static_cast<int>(std::lround((sheet.board_left_m + x_m) * scale)), 0, width);
        };
        const auto row = [&](double y_m) {
            return std::clamp(
                height - static_cast<int>(std::lround((sheet.board_bottom_m + y_m) * scale)),
                0,
                height);
        };
        const int left = column(r.left), right = column(r.left + r.width);
        const int top = row(r.bottom + r.height), bottom = row(r.bottom);
        page(cv::Rect(left, top, right - left, bottom - top)).setTo(value);
    };
    const Board& board = sheet.board;
    const double border = board.is_inverted ? 0.25 * board.square_m : 0.0;
    if (board.is_inverted)
        fill({-border,
              -border,
              board.square_m * board.columns + 2 * border,
              board.square_m * board.rows + 2 * border},
             0);
    for (const PrintedRect& r : printed_rects(board)) fill(r, board.is_inverted ? 255 : 0);
    const double line_m = std::max(0.0003, 1.0 / scale);
    fill({0.0, -border - 0.007, 0.1, line_m}, 0);
    fill({0.0, -border - 0.007, line_m, 0.004}, 0);
    fill({0.1 - line_m, -border - 0.007, line_m, 0.004}, 0);
    double y_m = sheet.board_bottom_m - border - 0.0115;
    for (const std::string& words : sheet.words) {
        cv::putText(
            page,
            words,
            {static_cast<int>(sheet.board_left_m * scale), height - static_cast<int>(y_m * scale)},
            cv::FONT_HERSHEY_SIMPLEX,
            scale * 0.0001,  // letters of about 2 mm
            cv::Scalar(0),
            std::max(1, static_cast<int>(scale * 0.0002)),
            cv::LINE_AA);
        y_m -= 0.0042;
    }
    std::vector<std::uint8_t> png;
    if (!cv::imencode(".png", page, png))
        return make_error(ErrorKind::kInternal, "the picture cannot be coded as PNG");
    return with_size_of_pixels(png, dpi);
}

}  // namespace atrium::calibrate
