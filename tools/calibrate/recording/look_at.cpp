#include "core/base/readable.hpp"
#include "site_node/capture/truncated_picture.hpp"
#include "site_node/capture/video_length.hpp"
#include "site_node/capture/video_rotation.hpp"
#include "tools/calibrate/recording/codec_rate.hpp"
#include "tools/calibrate/recording/shots.hpp"

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include <cmath>

namespace atrium::calibrate {
namespace {

constexpr const char* kEmptyText = "the file is empty; copy it again";

bool has_no_bytes(const std::filesystem::path& file) {
    std::error_code failure;
    return std::filesystem::file_size(file, failure) == 0 && !failure;
}

Error not_decoded(const std::filesystem::path& file) {
    if (const auto readable = check_readable(file); !readable) return readable.error();
    if (has_no_bytes(file)) return {ErrorKind::kInvalidData, file.string() + ": " + kEmptyText};
    if (capture::is_truncated_video(file)) {
        return {ErrorKind::kInvalidData, file.string() + ": " + capture::kTruncatedText};
    }
    return {
        ErrorKind::kInvalidData,
        fmt::format("{}: cannot be decoded; convert it, for example with `ffmpeg -i IN OUT.mp4`",
                    file.string())};
}

Error picture_not_decoded(const std::filesystem::path& file) {
    if (const auto readable = check_readable(file); !readable) return readable.error();
    if (has_no_bytes(file)) return {ErrorKind::kInvalidData, file.string() + ": " + kEmptyText};
    if (capture::is_truncated_picture(file)) {
        return {ErrorKind::kInvalidData,
                file.string() +
                    ": the file is truncated: it ends before its picture does; copy it again"};
    }
    return {ErrorKind::kInvalidData,
            file.string() +
                ": cannot be decoded: the file is damaged, or no picture; copy it again, or "
                "convert it to PNG"};
}

}  // namespace

// A truncated picture costs its instant: the hull of the site lacks this camera then.
std::string doubt_of_truncation(const Shots& shots, const Look& look) {
    if (look.num_frames < look.num_in_header) {
        return fmt::format("{}: {}; the site leaves out the instants after it",
                           shots.path.string(),
                           capture::text_of_truncated_video(look.num_frames, look.num_in_header));
    }
    std::vector<std::filesystem::path> bad;
    for (const auto& [number, file] : shots.pictures)
        if (capture::is_truncated_picture(file) || has_no_bytes(file)) bad.push_back(file);
    if (bad.empty()) return {};
    return fmt::format(
        "{} truncated: {}{}; copy them again; the site leaves these instants out",
        bad.size() == 1 ? "1 picture is" : fmt::format("{} pictures are", bad.size()),
        bad.front().string(),
        bad.size() == 1 ? "" : ", ...");
}

Expected<Look> look_at(const Shots& shots) try {
    Look look;
    if (!shots.is_video) {
        if (shots.pictures.empty()) return tl::unexpected(not_decoded(shots.path));
        const auto& file = shots.pictures.begin()->second;
        if (capture::is_truncated_picture(file)) return tl::unexpected(picture_not_decoded(file));
        const cv::Mat picture =
            cv::imread(file.string(), cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
        if (picture.empty()) return tl::unexpected(picture_not_decoded(file));
        look.width = picture.cols;
        look.height = picture.rows;
        look.num_frames = shots.num_pictures();
        return look;
    }
    cv::VideoCapture video(shots.path.string(), cv::CAP_FFMPEG);
    cv::Mat picture;
    if (!video.isOpened() || !video.read(picture) || picture.empty())
        return tl::unexpected(not_decoded(shots.path));
    look.width = picture.cols;
    look.height = picture.rows;
    look.rotation_deg = capture::rotation_tag_deg(video);
    const double rate_hz = video.get(cv::CAP_PROP_FPS);
    if (rate_hz >= 0.1 && rate_hz <= 1000.0) {
        look.rate_hz = rate_hz;
        look.codec_rate_hz = codec_rate_hz(shots.path);
    }
    const double count = video.get(cv::CAP_PROP_FRAME_COUNT);
    if (std::isfinite(count) && count > 0.0 && count < 1e9)
        look.num_in_header =
            capture::num_shown_pictures(shots.path, static_cast<std::size_t>(count));
    look.lost = capture::lost_pictures(shots.path);
    look.num_frames = capture::num_whole_pictures(shots.path, look.num_in_header);
    return look;
} catch (const cv::Exception&) {
    return tl::unexpected(shots.is_video ? not_decoded(shots.path)
                                         : picture_not_decoded(shots.pictures.begin()->second));
}

}  // namespace atrium::calibrate
