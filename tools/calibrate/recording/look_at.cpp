#include "tools/calibrate/recording/shots.hpp"

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include <cmath>

namespace atrium::calibrate {
namespace {

Error not_decoded(const std::filesystem::path& file) {
    return {
        ErrorKind::kInvalidData,
        fmt::format("{}: cannot be decoded; convert it, for example with `ffmpeg -i IN OUT.mp4`",
                    file.string())};
}

}  // namespace

Expected<Look> look_at(const Shots& shots) try {
    Look look;
    if (!shots.is_video) {
        if (shots.pictures.empty()) return tl::unexpected(not_decoded(shots.path));
        const auto& file = shots.pictures.begin()->second;
        const cv::Mat picture =
            cv::imread(file.string(), cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
        if (picture.empty()) return tl::unexpected(not_decoded(file));
        look = {picture.cols, picture.rows, 0.0, shots.pictures.size()};
        return look;
    }
    cv::VideoCapture video(shots.path.string());
    cv::Mat picture;
    if (!video.isOpened() || !video.read(picture) || picture.empty())
        return tl::unexpected(not_decoded(shots.path));
    look.width = picture.cols;
    look.height = picture.rows;
    const double rate_hz = video.get(cv::CAP_PROP_FPS);
    if (rate_hz >= 0.1 && rate_hz <= 1000.0) look.rate_hz = rate_hz;
    const double count = video.get(cv::CAP_PROP_FRAME_COUNT);
    if (std::isfinite(count) && count > 0.0 && count < 1e9)
        look.num_frames = static_cast<std::size_t>(count);
    return look;
} catch (const cv::Exception&) {
    return tl::unexpected(not_decoded(shots.path));
}

}  // namespace atrium::calibrate
