#include "core/codec/picture_encoder.hpp"
#include "viewer/record/video_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

extern "C" {
#include <libavformat/avformat.h>
}

namespace atrium::viewer {
namespace {

constexpr int kQuality = 85;
constexpr int kTimeBase = 1000;

struct FormatDeleter {
    void operator()(AVFormatContext* context) const {
        if (context == nullptr) return;
        avio_closep(&context->pb);
        avformat_free_context(context);
    }
};

struct PacketDeleter {
    void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};

tl::unexpected<Error> failed(const std::string& file, const char* what, int code) {
    std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
    av_strerror(code, text.data(), text.size());
    return make_error(ErrorKind::kUnavailable,
                      fmt::format("video {}: {}: {}", file, what, text.data()));
}

class JpegVideo : public VideoFile {
public:
    explicit JpegVideo(const VideoFormat& format)
        : file_(format.file.string()),
          width_(format.width),
          height_(format.height),
          period_{kTimeBase, std::max(1, static_cast<int>(std::lround(format.fps * kTimeBase)))} {}
    JpegVideo(const JpegVideo&) = delete;
    JpegVideo& operator=(const JpegVideo&) = delete;
    ~JpegVideo() override = default;

    Expected<void> begin();
    Expected<void> set(std::span<const std::uint8_t> rgba) override;
    Expected<void> write() override;
    Expected<void> finish() override;

private:
    std::string file_;
    int width_;
    int height_;
    AVRational period_;  // duration of a picture [s]
    std::unique_ptr<AVFormatContext, FormatDeleter> context_;
    AVStream* stream_ = nullptr;  // owned by `context_`
    std::unique_ptr<AVPacket, PacketDeleter> packet_{av_packet_alloc()};
    std::int64_t num_written_ = 0;

    codec::PictureEncoder encoder_;
    std::span<const std::uint8_t> jpeg_;  // owned by `encoder_`
};

Expected<void> JpegVideo::begin() {
    if (packet_ == nullptr) return failed(file_, "cannot allocate a packet", AVERROR(ENOMEM));
    AVFormatContext* context = nullptr;
    int code = avformat_alloc_output_context2(&context, nullptr, nullptr, file_.c_str());
    if (code < 0) return failed(file_, "unknown file format", code);
    context_.reset(context);
    stream_ = avformat_new_stream(context, nullptr);
    if (stream_ == nullptr) return failed(file_, "cannot add a stream", AVERROR(ENOMEM));
    AVCodecParameters& codec = *stream_->codecpar;
    codec.codec_type = AVMEDIA_TYPE_VIDEO;
    codec.codec_id = AV_CODEC_ID_MJPEG;
    codec.format = AV_PIX_FMT_YUVJ420P;
    codec.width = width_;
    codec.height = height_;
    stream_->time_base = period_;
    stream_->avg_frame_rate = {period_.den, period_.num};
    code = avio_open(&context->pb, file_.c_str(), AVIO_FLAG_WRITE);
    if (code < 0) return failed(file_, "cannot open the file", code);
    code = avformat_write_header(context, nullptr);
    if (code < 0) return failed(file_, "cannot write the header", code);
    return {};
}

Expected<void> JpegVideo::set(std::span<const std::uint8_t> rgba) {
    const auto jpeg = encoder_.encode(rgba, width_, height_, kQuality);
    if (!jpeg) {
        return make_error(
            ErrorKind::kUnavailable,
            fmt::format("video {}: cannot encode a picture: {}", file_, jpeg.error().message));
    }
    jpeg_ = *jpeg;
    return {};
}

Expected<void> JpegVideo::write() {
    AVPacket& packet = *packet_;
    packet.data = const_cast<std::uint8_t*>(jpeg_.data());  // only read
    packet.size = static_cast<int>(jpeg_.size());
    packet.pts = packet.dts = num_written_++;
    packet.duration = 1;
    packet.stream_index = stream_->index;
    packet.flags = AV_PKT_FLAG_KEY;
    av_packet_rescale_ts(&packet, period_, stream_->time_base);
    const int code = av_write_frame(context_.get(), &packet);
    if (code < 0) return failed(file_, "cannot write a picture", code);
    return {};
}

Expected<void> JpegVideo::finish() {
    const int written = av_write_trailer(context_.get());
    const int closed = avio_closep(&context_->pb);
    if (written < 0) return failed(file_, "cannot finish the file", written);
    if (closed < 0) return failed(file_, "cannot finish the file", closed);
    return {};
}

}  // namespace

Expected<std::unique_ptr<VideoFile>> create_jpeg_video(const VideoFormat& format) {
    auto video = std::make_unique<JpegVideo>(format);
    if (auto begun = video->begin(); !begun) return tl::unexpected(begun.error());
    return video;
}

}  // namespace atrium::viewer
