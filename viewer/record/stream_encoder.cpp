#include "viewer/record/stream_encoder.hpp"

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/opt.h>
}

namespace atrium::viewer {
namespace {

constexpr std::array kEncoders{"libx264", "mpeg4", "mpeg2video"};  // best first
constexpr int kRateBase = 1000;
constexpr double kKeyEvery_s = 2.0;

struct ContextDeleter {
    void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
};
struct FrameDeleter {
    void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};
struct EncodedDeleter {
    void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};
using Context = std::unique_ptr<AVCodecContext, ContextDeleter>;

tl::unexpected<Error> failed(const std::string& what, int code) {
    std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
    av_strerror(code, text.data(), text.size());
    return make_error(ErrorKind::kUnavailable, fmt::format("stream: {}: {}", what, text.data()));
}

// 0.12 bits per pixel: 3.3 Mbit/s for 1280x720 at 30 Hz.
int usual_kbps(const EncoderOptions& options) {
    const double bits = 0.12 * options.width * options.height * options.fps;
    return std::clamp(static_cast<int>(bits / 1000.0), 200, 20'000);
}

Expected<Context> open(const char* name, const EncoderOptions& options) {
    const AVCodec* codec = avcodec_find_encoder_by_name(name);
    if (codec == nullptr) return failed(name, AVERROR_ENCODER_NOT_FOUND);
    Context context(avcodec_alloc_context3(codec));
    if (context == nullptr) return failed(name, AVERROR(ENOMEM));
    const int per_base = std::max(1, static_cast<int>(std::lround(options.fps * kRateBase)));
    context->width = options.width;
    context->height = options.height;
    context->pix_fmt = AV_PIX_FMT_YUV420P;
    context->color_range = AVCOL_RANGE_MPEG;
    context->colorspace = AVCOL_SPC_SMPTE170M;
    context->color_primaries = AVCOL_PRI_BT709;
    context->color_trc = AVCOL_TRC_IEC61966_2_1;
    av_reduce(&context->time_base.num, &context->time_base.den, kRateBase, per_base, 60'000);
    context->framerate = {context->time_base.den, context->time_base.num};
    const std::int64_t kbps = options.kbps > 0 ? options.kbps : usual_kbps(options);
    context->bit_rate = 1000 * kbps;
    context->rc_max_rate = context->bit_rate;
    context->rc_buffer_size = static_cast<int>(context->bit_rate / 2);
    context->gop_size = std::max(1, static_cast<int>(std::lround(kKeyEvery_s * options.fps)));
    context->max_b_frames = 0;
    context->thread_count = 1;
    if (options.has_global_header) context->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    if (std::strcmp(name, "libx264") == 0) {
        av_opt_set(context->priv_data, "preset", "veryfast", 0);
        av_opt_set(context->priv_data, "tune", "zerolatency", 0);
        av_opt_set(context->priv_data, "forced-idr", "1", 0);
    }
    const int code = avcodec_open2(context.get(), codec, nullptr);
    if (code < 0) return failed(name, code);
    return context;
}

}  // namespace

struct StreamEncoder::Impl {
    Context context;
    std::unique_ptr<AVFrame, FrameDeleter> frame{av_frame_alloc()};
    std::unique_ptr<AVPacket, EncodedDeleter> packet{av_packet_alloc()};
    cv::Mat i420;
};

StreamEncoder::StreamEncoder(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
StreamEncoder::~StreamEncoder() = default;

Expected<std::unique_ptr<StreamEncoder>> StreamEncoder::create(const EncoderOptions& options) {
    auto impl = std::make_unique<Impl>();
    std::string reasons;
    for (const char* name : kEncoders) {
        auto context = open(name, options);
        if (context) {
            impl->context = std::move(*context);
            break;
        }
        reasons += (reasons.empty() ? "" : "; ") + context.error().message;
    }
    if (impl->context == nullptr) return make_error(ErrorKind::kUnavailable, reasons);
    AVFrame& frame = *impl->frame;
    frame.format = impl->context->pix_fmt;
    frame.width = options.width;
    frame.height = options.height;
    if (const int code = av_frame_get_buffer(&frame, 0); code < 0)
        return failed("cannot allocate a picture", code);
    return std::unique_ptr<StreamEncoder>(new StreamEncoder(std::move(impl)));
}

void StreamEncoder::set(std::span<const std::uint8_t> rgba) {
    const AVCodecContext& context = *impl_->context;
    const cv::Mat picture(context.height,
                          context.width,
                          CV_8UC4,
                          const_cast<std::uint8_t*>(rgba.data()));  // only read
    cv::cvtColor(picture, impl_->i420, cv::COLOR_RGBA2YUV_I420);
}

Expected<EncodedPicture> StreamEncoder::encode(std::int64_t index, bool is_key) {
    AVFrame& frame = *impl_->frame;
    if (const int code = av_frame_make_writable(&frame); code < 0)
        return failed("cannot allocate a picture", code);
    const std::uint8_t* plane = impl_->i420.data;
    for (int p = 0; p < 3; ++p) {
        const int width = p == 0 ? frame.width : frame.width / 2;
        const int height = p == 0 ? frame.height : frame.height / 2;
        for (int y = 0; y < height; ++y) {
            std::copy_n(
                plane, width, frame.data[p] + static_cast<std::ptrdiff_t>(y) * frame.linesize[p]);
            plane += width;
        }
    }
    frame.pts = index;
    frame.pict_type = is_key ? AV_PICTURE_TYPE_I : AV_PICTURE_TYPE_NONE;
    int code = avcodec_send_frame(impl_->context.get(), &frame);
    if (code >= 0) code = avcodec_receive_packet(impl_->context.get(), impl_->packet.get());
    if (code < 0) return failed("cannot encode a picture", code);
    const AVPacket& packet = *impl_->packet;
    EncodedPicture encoded{.bytes = {packet.data, packet.data + packet.size},
                           .index = packet.pts,
                           .is_key = (packet.flags & AV_PKT_FLAG_KEY) != 0};
    av_packet_unref(impl_->packet.get());
    return encoded;
}

std::string StreamEncoder::name() const { return impl_->context->codec->name; }
bool StreamEncoder::is_h264() const { return impl_->context->codec_id == AV_CODEC_ID_H264; }
const AVCodecContext& StreamEncoder::context() const { return *impl_->context; }

}  // namespace atrium::viewer
