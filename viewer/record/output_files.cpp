#include "viewer/record/output_files.hpp"

#include "core/app/log.hpp"
#include "core/base/write_check.hpp"
#include "viewer/record/picture_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <system_error>
#include <utility>

namespace atrium::viewer {
namespace {

// As the user reads it, who may not know the folder in which the viewer was started.
std::string shown(const std::filesystem::path& file) {
    std::error_code failure;
    const std::filesystem::path whole = std::filesystem::absolute(file, failure);
    return (failure ? file : whole.lexically_normal()).string();
}

}  // namespace

Expected<void> check_outputs(const ViewerConfig& config) {
    if (auto named = check_names(config); !named) return named;
    for (const std::filesystem::path& file : {config.output, config.video.file}) {
        if (file.empty()) continue;
        if (auto ready = prepare_file(file); !ready) return ready;
    }
    constexpr std::uint64_t kScreenshotBytes = 8U << 20;
    auto folder = check_folder_writable(config.screenshot_dir, kScreenshotBytes, "screenshot_dir");
    if (folder) return {};
    if (config.screenshot_dir != ViewerConfig().screenshot_dir) return folder;
    if (!config.headless) app::log::warn("no_screenshots reason=\"{}\"", folder.error().message);
    return {};
}

std::filesystem::path OutputFiles::next_file(const std::string& extension) const {
    // one number per picture and video, also of other worlds that this program showed before
    static std::atomic<int> num_files = 0;
    std::filesystem::path file;
    std::error_code failure;
    do {
        file = config_.screenshot_dir /
               fmt::format("atrium-{}-{:03}{}", getpid(), ++num_files, extension);
    } while (std::filesystem::exists(file, failure));  // of a program of that number, long ago
    return file;
}

Expected<void> OutputFiles::begin_video(const std::filesystem::path& file,
                                        const renderer::SceneRenderer& renderer) {
    const auto [width, height] = video_size(config_.video, {renderer.width(), renderer.height()});
    auto recorder = VideoRecorder::create(
        {.file = file, .fps = config_.video.fps, .width = width, .height = height});
    if (!recorder) return tl::unexpected(recorder.error());
    video_ = std::move(*recorder);
    video_file_ = file;
    return {};
}

Expected<void> OutputFiles::open(const renderer::SceneRenderer& renderer) {
    if (!config_.output.empty()) {
        if (auto ready = prepare_file(config_.output); !ready) return ready;
    }
    if (auto opened = live_.open(renderer); !opened) return opened;
    if (config_.video.file.empty()) return {};
    is_asked_for_ = true;
    return begin_video(config_.video.file, renderer);
}

Expected<void> OutputFiles::close() {
    live_.close();
    return close_video();
}

Expected<void> OutputFiles::close_video() {
    if (!video_) return {};
    const auto finished = video_->finish();
    const double length_s = *video_s();
    const std::uint64_t num_dropped = video_->num_dropped();
    num_dropped_before_ += num_dropped;
    video_.reset();
    is_asked_for_ = false;
    if (!finished) return finished;
    app::log::info("video_written file={} length_s={:.1f} dropped={}",
                   video_file_.string(),
                   length_s,
                   num_dropped);
    return {};
}

void OutputFiles::add(const renderer::SceneRenderer& renderer, bool counts) {
    live_.add(renderer);
    const auto now = VideoRecorder::Clock::now();
    if (!video_ || (is_asked_for_ && !counts)) return;
    const std::uint64_t num_dropped = video_->num_dropped();
    if (!video_->wants_picture(now)) {
        if (video_->num_dropped() > num_dropped)
            drops_.warn("video_dropped file=" + video_file_.string() + " the encoder is too slow");
        return;
    }
    renderer::RenderedPicture frame = video_->spent();
    renderer.read_pixels(frame);
    video_->offer(std::move(frame), now);
}

std::optional<double> OutputFiles::video_s() const {
    if (!video_) return std::nullopt;
    return static_cast<double>(video_->num_written()) / config_.video.fps;
}

std::string OutputFiles::toggle_video(const renderer::SceneRenderer& renderer) {
    if (video_) {
        const auto closed = close_video();
        return closed ? "video in " + shown(video_file_) : closed.error().message;
    }
    const auto begun = begin_video(next_file(".avi"), renderer);
    return begun ? "recording into " + shown(video_file_) : begun.error().message;
}

std::string OutputFiles::screenshot(const renderer::SceneRenderer& renderer) {
    renderer.read_pixels(picture_);
    const auto file = next_file(".png");
    const auto written = write_png(file, picture_);
    return written ? "screenshot in " + shown(file) : written.error().message;
}

Expected<void> OutputFiles::write_output(const renderer::SceneRenderer& renderer) {
    if (config_.output.empty()) return {};
    renderer.read_pixels(picture_);
    auto written = write_png(config_.output, picture_);
    if (written) app::log::info("picture_written file={}", config_.output.string());
    return written;
}

}  // namespace atrium::viewer
