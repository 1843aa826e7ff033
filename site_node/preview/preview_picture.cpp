#include "site_node/preview/preview_picture.hpp"

#include "core/image/block_luma.hpp"

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <system_error>

namespace atrium::preview {
namespace {

constexpr int kBarHeight_px = 26;  // below each view, for the caption
constexpr int kGap_px = 4;
constexpr double kTint = 0.35;
const cv::Scalar kInk(240, 240, 240);
const cv::Scalar kGround(28, 28, 28);
const cv::Scalar kMissing(60, 60, 60);
const cv::Scalar kSilhouette(80, 220, 60);  // green, which few people wear
const cv::Scalar kMark(40, 160, 255);

struct Grid {
    int columns = 1;
    int rows = 1;
    cv::Size view;  // size of the largest view

    cv::Size cell() const { return {view.width, view.height + kBarHeight_px}; }
    cv::Size size() const {
        return {columns * (view.width + kGap_px) + kGap_px,
                rows * (cell().height + kGap_px) + kGap_px};
    }
    cv::Point corner(std::size_t i) const {
        const auto index = static_cast<int>(i);
        return {kGap_px + index % columns * (view.width + kGap_px),
                kGap_px + index / columns * (cell().height + kGap_px)};
    }
};

// Returns the grid whose aspect ratio is nearest to that of a screen.
Grid grid_for(const std::vector<View>& views) {
    constexpr double kScreen = 16.0 / 9.0;
    Grid grid;
    grid.view = {320, 240};
    for (const View& view : views) {
        if (view.image.empty()) continue;
        grid.view.width = std::max(grid.view.width, view.image.width / 2);
        grid.view.height = std::max(grid.view.height, view.image.height / 2);
    }
    const auto n = std::max(static_cast<int>(views.size()), 1);
    double best = std::numeric_limits<double>::infinity();
    for (int columns = 1; columns <= n; ++columns) {
        Grid candidate = grid;
        candidate.columns = columns;
        candidate.rows = (n + columns - 1) / columns;
        const cv::Size size = candidate.size();
        const double form = std::abs(
            std::log(static_cast<double>(size.width) / static_cast<double>(size.height) / kScreen));
        const double empty = static_cast<double>(candidate.columns * candidate.rows - n) / n;
        if (form + empty >= best) continue;
        best = form + empty;
        grid.columns = candidate.columns;
        grid.rows = candidate.rows;
    }
    return grid;
}

// Writes one pixel per 2x2 block: its chroma and mean luma.
void halve(const image::YuvView& picture, cv::Mat out) {
    const image::RowCode code = image::best_row_code();
    std::vector<std::uint8_t> luma(static_cast<std::size_t>(out.cols));
    for (int y = 0; y < out.rows; ++y) {
        image::luma_of_blocks(picture, {0, 2 * y, out.cols}, code, luma.data());
        const std::uint8_t* cb = picture.u.row(y);
        const std::uint8_t* cr = picture.v.row(y);
        auto* pixel = out.ptr<cv::Vec3b>(y);
        for (int x = 0; x < out.cols; ++x) {
            const float u = static_cast<float>(cb[x]) - 128.0F;
            const float v = static_cast<float>(cr[x]) - 128.0F;
            const auto value = static_cast<float>(luma[static_cast<std::size_t>(x)]);
            pixel[x] = {cv::saturate_cast<std::uint8_t>(value + 1.772F * u),
                        cv::saturate_cast<std::uint8_t>(value - 0.344136F * u - 0.714136F * v),
                        cv::saturate_cast<std::uint8_t>(value + 1.402F * v)};
        }
    }
}

// Converts outlines to 1/16 px of the halved picture, whose pixel centres are those of the blocks.
constexpr int kShift = 4;
std::vector<std::vector<cv::Point>> halved(const View& view) {
    std::vector<std::vector<cv::Point>> outlines;
    for (const auto& outline : view.outlines_px) {
        auto& points = outlines.emplace_back();
        for (const Eigen::Vector2d& p : outline) {
            const Eigen::Vector2d half = (p.array() - 0.5) / 2.0 * (1 << kShift);
            points.emplace_back(cvRound(half.x()), cvRound(half.y()));
        }
    }
    return outlines;
}

void draw_silhouette(const View& view, cv::Mat picture) {
    const auto outlines = halved(view);
    if (outlines.empty()) return;
    cv::Mat tinted = picture.clone();
    cv::fillPoly(tinted, outlines, kSilhouette, cv::LINE_8, kShift);
    cv::addWeighted(tinted, kTint, picture, 1.0 - kTint, 0.0, picture);
    cv::polylines(picture, outlines, true, kSilhouette, 1, cv::LINE_AA, kShift);
}

void draw_marks(const View& view, cv::Mat picture) {
    constexpr int kRadius_px = 6;
    for (const Eigen::Vector2d& p : view.marks_px) {
        const Eigen::Vector2d half = (p.array() - 0.5) / 2.0 * (1 << kShift);
        cv::circle(picture,
                   {cvRound(half.x()), cvRound(half.y())},
                   kRadius_px << kShift,
                   kMark,
                   1,
                   cv::LINE_AA,
                   kShift);
    }
}

void write(cv::Mat canvas, cv::Point corner, const std::string& text, const cv::Scalar& colour) {
    cv::putText(canvas, text, corner, cv::FONT_HERSHEY_SIMPLEX, 0.48, colour, 1, cv::LINE_AA);
}

void draw_view(const View& view, const Grid& grid, cv::Point corner, cv::Mat canvas) {
    const cv::Rect area(corner, grid.view);
    if (view.image.empty()) {
        canvas(area).setTo(kMissing);
        write(canvas, corner + cv::Point(12, grid.view.height / 2), "no picture", kInk);
    } else {
        image::YuvImage buffer;
        const image::YuvView picture = image::working_view(view.image, buffer);
        const cv::Size size(picture.width() / 2, picture.height() / 2);
        const cv::Point centred((area.width - size.width) / 2, (area.height - size.height) / 2);
        cv::Mat place = canvas(cv::Rect(corner + centred, size));
        halve(picture, place);
        if (view.brightness != 1.0) place.convertTo(place, CV_8U, view.brightness);
        draw_silhouette(view, place);
        draw_marks(view, place);
    }
    const std::string words = !view.caption.empty()
                                  ? view.caption
                                  : fmt::format("{}  {:.1f}/s  foreground {:.1f} %",
                                                view.name,
                                                view.frames_per_s,
                                                100.0 * view.foreground_share);
    write(canvas, corner + cv::Point(6, grid.view.height + kBarHeight_px - 8), words, kInk);
}

}  // namespace

void draw(const std::vector<View>& views, Picture& out) {
    const Grid grid = grid_for(views);
    const cv::Size size = grid.size();
    out.width = size.width;
    out.height = size.height;
    out.bgr.resize(static_cast<std::size_t>(size.area()) * 3);
    cv::Mat canvas(size, CV_8UC3, out.bgr.data());
    canvas.setTo(kGround);
    for (std::size_t i = 0; i < views.size(); ++i)
        draw_view(views[i], grid, grid.corner(i), canvas);
}

Expected<void> write_png(const std::filesystem::path& file, const Picture& picture) {
    const auto failed = [&](const std::string& why) {
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("cannot write picture {}: {}", file.string(), why));
    };
    std::filesystem::path part = file;
    part += ".part.png";
    std::error_code failure;
    if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), failure);
    const cv::Mat bgr(
        picture.height, picture.width, CV_8UC3, const_cast<std::uint8_t*>(picture.bgr.data()));
    try {
        // noise does not compress: more effort is useless
        if (!cv::imwrite(part.string(), bgr, {cv::IMWRITE_PNG_COMPRESSION, 1}))
            return failed("cannot create the file");
    } catch (const cv::Exception& error) {
        return failed(error.what());
    }
    std::filesystem::rename(part, file, failure);
    if (failure) return failed(failure.message());
    return {};
}

}  // namespace atrium::preview
