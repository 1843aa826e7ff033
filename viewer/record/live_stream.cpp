#include "viewer/record/live_stream.hpp"

#include "core/app/log.hpp"

#include <cstdarg>
#include <utility>

extern "C" {
#include <libavutil/log.h>
}

namespace atrium::viewer {
namespace {

using Clock = std::chrono::steady_clock;

// Older pictures are not worth encoding: the process was stopped or the machine slept.
constexpr std::chrono::duration<double> kOldest{2.0};

}  // namespace

Expected<std::unique_ptr<LiveStream>> LiveStream::create(const std::string& url,
                                                         const VideoFormat& format,
                                                         int kbps) {
    auto target = parse_stream(url);
    if (!target) return tl::unexpected(target.error());
    // The sender reports what happens, once and without secrets. OpenCV's videos set the level
    // again.
    av_log_set_callback([](void*, int, const char*, va_list) {});
    std::unique_ptr<LiveStream> stream(new LiveStream);
    stream->target_ = std::move(*target);
    stream->fps_ = format.fps;
    const bool is_flv = stream->target_.format == "flv";
    auto encoder = StreamEncoder::create({.width = format.width,
                                          .height = format.height,
                                          .fps = format.fps,
                                          .kbps = kbps,
                                          .has_global_header = is_flv});
    if (!encoder) return tl::unexpected(encoder.error());
    stream->encoder_ = std::move(*encoder);
    if (is_flv && !stream->encoder_->is_h264()) {
        return make_error(ErrorKind::kUnavailable,
                          "video.stream: rtmp needs H.264, which this libavcodec cannot encode. "
                          "Install one with libx264, or stream by srt");
    }
    app::log::info("stream_begins to={} encoder={} width={} height={} fps={}",
                   stream->target_.shown,
                   stream->encoder_->name(),
                   format.width,
                   format.height,
                   format.fps);
    stream->sender_ = std::make_unique<StreamSender>(stream->target_, stream->encoder_->context());
    return stream;
}

Expected<void> LiveStream::set(std::span<const std::uint8_t> rgba) {
    encoder_->set(rgba);
    return {};
}

Expected<void> LiveStream::write() {
    if (num_written_ == 0) begin_ = Clock::now();
    const std::int64_t index = num_written_++;
    const bool is_connected = sender_->is_connected();
    const bool is_new = is_connected && !std::exchange(was_connected_, is_connected);
    was_connected_ = is_connected;
    const std::chrono::duration<double> due(static_cast<double>(index) / fps_);
    const bool is_old = Clock::now() - begin_ > due + kOldest;
    if (!is_connected || is_old) return {};
    auto encoded = encoder_->encode(index, sender_->wants_key() || is_new);
    if (!encoded) return tl::unexpected(encoded.error());
    sender_->offer(std::move(*encoded));
    return {};
}

Expected<void> LiveStream::finish() {
    sender_.reset();
    return {};
}

}  // namespace atrium::viewer
