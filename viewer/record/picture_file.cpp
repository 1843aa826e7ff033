#include "viewer/record/picture_file.hpp"

#include "core/base/write_check.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <cerrno>
#include <fstream>
#include <system_error>

namespace atrium::viewer {
namespace {

cv::Mat bgr_of(const renderer::RenderedPicture& picture) {
    const cv::Mat rgba(picture.height,
                       picture.width,
                       CV_8UC4,
                       const_cast<std::uint8_t*>(picture.rgba.data()));  // only read
    cv::Mat bgr;
    cv::cvtColor(rgba, bgr, cv::COLOR_RGBA2BGR);
    return bgr;
}

}  // namespace

Expected<void> prepare_file(const std::filesystem::path& file) {
    std::error_code failure;
    if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), failure);
    errno = 0;
    if (std::filesystem::exists(file, failure) && !std::ofstream(file, std::ios::app)) {
        return make_error(
            ErrorKind::kUnavailable,
            "cannot write " + file.string() + ": " + std::generic_category().message(errno));
    }
    return probe_file(file.string() + ".part");
}

Expected<void> write_png(const std::filesystem::path& file,
                         const renderer::RenderedPicture& picture) {
    std::filesystem::path part = file;
    part += ".part.png";
    std::error_code failure;
    if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), failure);
    try {
        if (!cv::imwrite(part.string(), bgr_of(picture), {cv::IMWRITE_PNG_COMPRESSION, 3})) {
            return make_error(ErrorKind::kUnavailable, "cannot write picture " + file.string());
        }
    } catch (const cv::Exception& error) {
        return make_error(ErrorKind::kUnavailable,
                          "cannot write picture " + file.string() + ": " + error.what());
    }
    std::filesystem::rename(part, file, failure);
    if (failure) {
        return make_error(ErrorKind::kUnavailable,
                          "cannot write picture " + file.string() + ": " + failure.message());
    }
    return {};
}

}  // namespace atrium::viewer
