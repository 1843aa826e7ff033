#include "viewer/picture_file.hpp"

#include "core/app/log.hpp"

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <system_error>

namespace atrium::viewer {
namespace {

cv::Mat bgr_of(const renderer::RenderedPicture& picture) {
    const cv::Mat rgba(
        picture.height, picture.width, CV_8UC4, const_cast<std::uint8_t*>(picture.rgba.data()));
    cv::Mat bgr;
    cv::cvtColor(rgba, bgr, cv::COLOR_RGBA2BGR);
    return bgr;
}

// What a video still needs to be finished: a picture, and an index of all of them.
bool is_nearly_full(const std::filesystem::path& file) {
    constexpr std::uintmax_t kLeast = 8'000'000;
    std::error_code failure;
    const auto space = std::filesystem::space(file, failure);
    return !failure && space.available < kLeast;
}

}  // namespace

Expected<void> prepare_file(const std::filesystem::path& file) {
    std::error_code failure;
    if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), failure);
    const bool is_there = std::filesystem::exists(file, failure);
    errno = 0;
    if (!std::ofstream(file, std::ios::app)) {
        return make_error(
            ErrorKind::kUnavailable,
            "cannot write " + file.string() + ": " + std::generic_category().message(errno));
    }
    if (!is_there) std::filesystem::remove(file, failure);
    return {};
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

struct VideoRecorder::Impl {
    VideoFormat format;
    cv::VideoWriter writer;
};

VideoRecorder::VideoRecorder(std::unique_ptr<Impl> impl)
    : impl_(std::move(impl)), thread_([this](std::stop_token stop) { record(stop); }) {}

VideoRecorder::~VideoRecorder() {
    if (thread_.joinable()) static_cast<void>(finish());
}

Expected<void> VideoRecorder::finish() {
    thread_.request_stop();
    thread_.join();
    impl_->writer.release();
    const std::string file = impl_->format.file.string();
    if (is_disk_full_) {
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("video {} ends after {:.1f} s: the disk is full",
                                      file,
                                      static_cast<double>(num_written_) / impl_->format.fps));
    }
    // OpenCV tells of nothing that goes wrong as it writes; asked for no backend, it tries cameras
    // too
    if (num_written_ > 0 && !cv::VideoCapture(file, cv::CAP_FFMPEG).grab())
        return make_error(ErrorKind::kUnavailable, "video " + file + " cannot be read again");
    return {};
}

Expected<std::unique_ptr<VideoRecorder>> VideoRecorder::create(const VideoFormat& format) {
    // OpenCV's own words for a file that cannot be written are many and name no reason
    if (const auto ready = prepare_file(format.file); !ready) return tl::unexpected(ready.error());
    auto impl = std::make_unique<Impl>();
    impl->format = format;
    const int fourcc = format.file.extension() == ".mp4"
                           ? cv::VideoWriter::fourcc('m', 'p', '4', 'v')
                           : cv::VideoWriter::fourcc('M', 'J', 'P', 'G');
    bool is_open = false;
    try {
        is_open = impl->writer.open(
            format.file.string(), fourcc, format.fps, cv::Size(format.width, format.height));
    } catch (const cv::Exception&) {
        is_open = false;
    }
    if (!is_open) {
        return make_error(ErrorKind::kUnavailable, "cannot write video " + format.file.string());
    }
    return std::unique_ptr<VideoRecorder>(new VideoRecorder(std::move(impl)));
}

bool VideoRecorder::wants_picture() const { return wants_picture_; }

void VideoRecorder::offer(renderer::RenderedPicture picture) {
    wants_picture_ = false;
    slot_.put(std::move(picture));
}

void VideoRecorder::record(std::stop_token stop) {
    using Clock = std::chrono::steady_clock;
    const auto period = std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double>(1.0 / impl_->format.fps));
    std::optional<renderer::RenderedPicture> newest = slot_.take(stop);
    cv::Mat frame;
    std::mutex mutex;
    std::condition_variable_any never;
    for (Clock::time_point due = Clock::now(); newest; due += period) {
        frame = bgr_of(*newest);
        const cv::Size size(impl_->format.width, impl_->format.height);
        if (frame.size() != size) cv::resize(frame, frame, size, 0, 0, cv::INTER_AREA);
        impl_->writer.write(frame);
        ++num_written_;
        if (stop.stop_requested()) return;
        if (is_nearly_full(impl_->format.file)) {
            is_disk_full_ = true;
            app::log::warn("video_ends file={} the disk is full", impl_->format.file.string());
            return;
        }
        wants_picture_ = true;
        // a writer that cannot keep up leaves pictures out rather than falling behind
        due = std::max(due, Clock::now() - period);
        std::unique_lock lock(mutex);
        never.wait_until(lock, stop, due + period, [] { return false; });
        if (auto next = slot_.try_take()) newest = std::move(next);
    }
}

}  // namespace atrium::viewer
