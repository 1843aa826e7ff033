#include "viewer/record/live_outputs.hpp"

#include "core/app/log.hpp"

#include <fmt/format.h>

#include <utility>

namespace atrium::viewer {

Expected<void> LiveOutputs::open(const renderer::SceneRenderer& renderer) {
    const auto [width, height] = video_size(config_.video, {renderer.width(), renderer.height()});
    const VideoFormat format{
        .file = {}, .fps = config_.video.fps, .width = width, .height = height};
    if (!config_.video.stream.empty()) {
        if (auto opened = open_stream(format); !opened) return opened;
    }
    if (!config_.video.virtual_camera.empty()) {
        if (auto opened = open_camera(format); !opened) {
            close();
            return opened;
        }
    }
    return {};
}

Expected<void> LiveOutputs::open_stream(const VideoFormat& format) {
    auto stream = LiveStream::create(config_.video.stream, format, config_.video.stream_kbps);
    if (!stream) return tl::unexpected(stream.error());
    stream_target_ = stream->get();
    stream_ = {VideoRecorder::start(format, std::move(*stream)), format.fps};
    return {};
}

Expected<void> LiveOutputs::open_camera(const VideoFormat& format) {
    auto camera = VirtualCamera::create(config_.video.virtual_camera.string(), format);
    if (!camera) return tl::unexpected(camera.error());
    VideoFormat own = format;
    own.width = (*camera)->width();
    own.height = (*camera)->height();
    app::log::info("virtual_camera device={} format={} width={} height={} fps={}",
                   config_.video.virtual_camera.string(),
                   (*camera)->pixel_format(),
                   own.width,
                   own.height,
                   own.fps);
    camera_target_ = camera->get();
    camera_ = {VideoRecorder::start(own, std::move(*camera)), own.fps};
    return {};
}

void LiveOutputs::close() {
    num_dropped_before_ += num_dropped_now();
    for (Output* output : {&stream_, &camera_}) {
        if (output->recorder == nullptr) continue;
        const double length_s = output->length_s();
        const auto finished = output->recorder->finish();
        app::log::info("{} length_s={:.1f}{}",
                       output == &stream_ ? "stream_ends" : "virtual_camera_ends",
                       length_s,
                       finished ? "" : fmt::format(" error=\"{}\"", finished.error().message));
        output->recorder.reset();
    }
    stream_target_ = nullptr;
    camera_target_ = nullptr;
}

void LiveOutputs::add(const renderer::SceneRenderer& renderer) {
    const auto now = VideoRecorder::Clock::now();
    const bool stream_wants = stream_.recorder && stream_.recorder->wants_picture(now);
    const bool camera_wants = camera_.recorder && camera_.recorder->wants_picture(now);
    if (!stream_wants && !camera_wants) return;
    Output& first = stream_wants ? stream_ : camera_;
    renderer::RenderedPicture picture = first.recorder->spent();
    renderer.read_pixels(picture);
    if (stream_wants && camera_wants) camera_.recorder->offer(picture, now);
    first.recorder->offer(std::move(picture), now);
}

std::string LiveOutputs::toggle(const renderer::SceneRenderer& renderer) {
    if (config_.video.stream.empty() && config_.video.virtual_camera.empty())
        return "no stream: start the viewer with --video.stream or --video.virtual_camera";
    if (is_running()) {
        close();
        return "stream ended";
    }
    const auto opened = open(renderer);
    return opened ? "stream begins" : opened.error().message;
}

std::string LiveOutputs::description() const {
    std::string text;
    if (stream_target_ != nullptr) {
        const std::string problem = stream_target_->sender().problem();
        text = fmt::format("stream to {}: {}",
                           stream_target_->target().shown,
                           problem.empty() ? fmt::format("{:.0f} s", stream_.length_s()) : problem);
    }
    if (camera_target_ != nullptr) {
        text += fmt::format("{}virtual camera {}: {:.0f} s",
                            text.empty() ? "" : "; ",
                            config_.video.virtual_camera.string(),
                            camera_.length_s());
    }
    return text.empty() ? text : text + "   F10: stop";
}

std::uint64_t LiveOutputs::num_dropped_now() const {
    std::uint64_t num = 0;
    if (stream_target_ != nullptr)
        num += stream_.recorder->num_dropped() + stream_target_->sender().num_dropped();
    if (camera_target_ != nullptr)
        num += camera_.recorder->num_dropped() + camera_target_->num_dropped();
    return num;
}

std::uint64_t LiveOutputs::num_dropped() const { return num_dropped_before_ + num_dropped_now(); }

}  // namespace atrium::viewer
