#include "tests/golden/golden_file.hpp"

#include "tests/support/source_dir.hpp"
#include "viewer/record/picture_file.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace atrium::golden {
namespace {

void write(const std::filesystem::path& file, const renderer::RenderedPicture& picture) {
    const auto written = viewer::write_png(file, picture);
    EXPECT_TRUE(written) << written.error().message;
}

renderer::RenderedPicture read(const std::filesystem::path& file) {
    cv::Mat rgba;
    const cv::Mat bgr = cv::imread(file.string());
    if (bgr.empty()) return {};
    cv::cvtColor(bgr, rgba, cv::COLOR_BGR2RGBA);
    return {.width = rgba.cols, .height = rgba.rows, .rgba = {rgba.datastart, rgba.dataend}};
}

}  // namespace

std::filesystem::path golden_file(const std::string& name) {
    return std::filesystem::path(atrium::test::source_dir() + "/tests/golden") / (name + ".png");
}

void renew_golden(const std::string& name, const renderer::RenderedPicture& picture) {
    const cv::Mat rgba(
        picture.height, picture.width, CV_8UC4, const_cast<std::uint8_t*>(picture.rgba.data()));
    cv::Mat bgr;
    cv::cvtColor(rgba, bgr, cv::COLOR_RGBA2BGR);
    // as small as possible, because they stay in the history
    EXPECT_TRUE(cv::imwrite(golden_file(name).string(), bgr, {cv::IMWRITE_PNG_COMPRESSION, 9}));
}

void expect_golden(const std::string& name,
                   const renderer::RenderedPicture& picture,
                   const Limits& limits) {
    const renderer::RenderedPicture golden = read(golden_file(name));
    const auto folder = std::filesystem::path(testing::TempDir()) / "atrium_golden";
    const auto actual_file = folder / (name + "_actual.png");
    if (golden.width != picture.width || golden.height != picture.height) {
        write(actual_file, picture);
        ADD_FAILURE() << golden_file(name) << " is missing or of another size than "
                      << picture.width << " x " << picture.height << "; what was drawn is in "
                      << actual_file;
        return;
    }
    const PictureDifference difference = picture_difference(golden, picture);
    if (is_within(difference, limits)) return;
    const auto difference_file = folder / (name + "_difference.png");
    write(actual_file, picture);
    write(difference_file, as_picture(difference, picture.width));
    ADD_FAILURE() << describe(difference) << "; what was drawn is in " << actual_file
                  << ", where it differs from " << golden_file(name) << " in " << difference_file;
}

std::string describe(const PictureDifference& difference) {
    return fmt::format(
        "delta E: mean {:.3f}, 99.9th percentile {:.2f}, more than 5 in {:.3f} % of the pixels",
        difference.mean,
        difference.percentile_99_9,
        100.0 * difference.share_over_5);
}

}  // namespace atrium::golden
