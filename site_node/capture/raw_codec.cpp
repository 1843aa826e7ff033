#include "site_node/capture/raw_codec.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <limits>
#include <utility>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/error.h>
#include <libavutil/log.h>
#include <libavutil/opt.h>
}

namespace atrium::capture {
namespace {

// Raises the level of FFmpeg's lines on standard error above what is shown: errors are reported.
constexpr int kQuiet = AV_LOG_TRACE;

// Beyond what any of the codecs writes for the largest sheet.
constexpr std::size_t kMaxCodecData = 1U << 20;

template <auto kFree>
struct FreeAv {
    template <typename T>
    void operator()(T* object) const {
        kFree(&object);
    }
};
using ContextPtr = std::unique_ptr<AVCodecContext, FreeAv<avcodec_free_context>>;
using FramePtr = std::unique_ptr<AVFrame, FreeAv<av_frame_free>>;
using PacketPtr = std::unique_ptr<AVPacket, FreeAv<av_packet_free>>;

AVCodecID id_of(RawCodec codec) {
    return codec == RawCodec::kFfv1 ? AV_CODEC_ID_FFV1 : AV_CODEC_ID_FFVHUFF;
}

std::string av_error_text(int error) {
    std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
    return av_make_error_string(text.data(), text.size(), error);
}

// Both codecs begin each picture anew: every picture decodes alone.
bool set_options(AVCodecContext& context, RawCodec codec) {
    const auto set = [&](const char* key, const char* value) {
        return av_opt_set(&context, key, value, AV_OPT_SEARCH_CHILDREN) >= 0;
    };
    // context: each picture has the tables that fit it
    if (codec == RawCodec::kHuffYuv) return set("pred", "left") && set("context", "1");
    // the sum of a record finds damage already
    return set("level", "3") && set("coder", "rice") && set("context", "0") && set("slicecrc", "0");
}

FramePtr make_grey_frame(const SheetSize& size) {
    FramePtr frame(av_frame_alloc());
    if (frame == nullptr) return nullptr;
    frame->format = AV_PIX_FMT_GRAY8;
    frame->width = size.width;
    frame->height = size.height;
    return av_frame_get_buffer(frame.get(), 0) >= 0 ? std::move(frame) : nullptr;
}

std::size_t bytes_of(const SheetSize& size) {
    return static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
}

}  // namespace

const char* name_of(RawCodec codec) {
    switch (codec) {
        case RawCodec::kRaw:
            return "raw";
        case RawCodec::kFfv1:
            return "ffv1";
        case RawCodec::kHuffYuv:
            return "huffyuv";
    }
    return "unknown";
}

struct SheetEncoder::Impl {
    SheetSize size;
    ContextPtr context;
    FramePtr frame;
    PacketPtr packet;
};

SheetEncoder::SheetEncoder(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SheetEncoder::SheetEncoder(SheetEncoder&&) noexcept = default;
SheetEncoder& SheetEncoder::operator=(SheetEncoder&&) noexcept = default;
SheetEncoder::~SheetEncoder() = default;

Expected<SheetEncoder> SheetEncoder::open(RawCodec codec, const SheetSize& size) {
    assert(codec != RawCodec::kRaw);
    auto impl = std::make_unique<Impl>();
    impl->size = size;
    const AVCodec* found = avcodec_find_encoder(id_of(codec));
    const auto unavailable = [&](const std::string& reason) {
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("record.codec: {} cannot encode {}x{} px: {}; give another",
                                      name_of(codec),
                                      size.width,
                                      size.height,
                                      reason));
    };
    if (found == nullptr) return unavailable("this libavcodec lacks it");
    impl->context.reset(avcodec_alloc_context3(found));
    impl->frame = make_grey_frame(size);
    impl->packet.reset(av_packet_alloc());
    if (!impl->context || !impl->frame || !impl->packet) return unavailable("no memory");
    impl->context->log_level_offset = kQuiet;
    impl->context->width = size.width;
    impl->context->height = size.height;
    impl->context->pix_fmt = AV_PIX_FMT_GRAY8;
    impl->context->color_range = AVCOL_RANGE_JPEG;
    impl->context->time_base = {1, 1000};
    impl->context->gop_size = 1;
    impl->context->thread_count = 1;
    if (!set_options(*impl->context, codec)) return unavailable("this libavcodec is too old");
    if (const int error = avcodec_open2(impl->context.get(), found, nullptr); error < 0)
        return unavailable(av_error_text(error));
    return SheetEncoder(std::move(impl));
}

std::vector<std::uint8_t> SheetEncoder::codec_data() const {
    const std::uint8_t* data = impl_->context->extradata;
    return {data, data + impl_->context->extradata_size};
}

Expected<void> SheetEncoder::encode(std::span<const std::uint8_t> sheet,
                                    std::vector<std::uint8_t>& out) {
    assert(sheet.size() == bytes_of(impl_->size));
    AVFrame& frame = *impl_->frame;
    const auto failed = [](int error) {
        return make_error(ErrorKind::kInternal,
                          fmt::format("a picture cannot be compressed: {}", av_error_text(error)));
    };
    if (const int error = av_frame_make_writable(&frame); error < 0) return failed(error);
    for (int y = 0; y < impl_->size.height; ++y) {
        std::copy_n(sheet.data() + static_cast<std::ptrdiff_t>(y) * impl_->size.width,
                    impl_->size.width,
                    frame.data[0] + static_cast<std::ptrdiff_t>(y) * frame.linesize[0]);
    }
    ++frame.pts;
    if (const int error = avcodec_send_frame(impl_->context.get(), &frame); error < 0)
        return failed(error);
    if (const int error = avcodec_receive_packet(impl_->context.get(), impl_->packet.get());
        error < 0)
        return failed(error);
    out.assign(impl_->packet->data, impl_->packet->data + impl_->packet->size);
    av_packet_unref(impl_->packet.get());
    return {};
}

struct SheetDecoder::Impl {
    SheetSize size;
    ContextPtr context;
    FramePtr frame;
    PacketPtr packet;

    // Two, as FFmpeg may keep a picture back until the input ends.
    int receive() {
        const int error = avcodec_receive_frame(context.get(), frame.get());
        if (error != AVERROR(EAGAIN)) return error;
        if (const int ended = avcodec_send_packet(context.get(), nullptr); ended < 0) return ended;
        const int last = avcodec_receive_frame(context.get(), frame.get());
        avcodec_flush_buffers(context.get());
        return last;
    }
};

SheetDecoder::SheetDecoder(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SheetDecoder::SheetDecoder(SheetDecoder&&) noexcept = default;
SheetDecoder& SheetDecoder::operator=(SheetDecoder&&) noexcept = default;
SheetDecoder::~SheetDecoder() = default;

Expected<SheetDecoder> SheetDecoder::open(RawCodec codec,
                                          const SheetSize& size,
                                          std::span<const std::uint8_t> codec_data) {
    assert(codec != RawCodec::kRaw);
    auto impl = std::make_unique<Impl>();
    impl->size = size;
    const auto invalid = [&](const std::string& reason) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("cannot decode {}: {}", name_of(codec), reason));
    };
    const AVCodec* found = avcodec_find_decoder(id_of(codec));
    if (found == nullptr) return invalid("this libavcodec lacks it");
    if (codec_data.size() > kMaxCodecData) return invalid("its codec data are too long");
    impl->context.reset(avcodec_alloc_context3(found));
    impl->frame.reset(av_frame_alloc());
    impl->packet.reset(av_packet_alloc());
    if (!impl->context || !impl->frame || !impl->packet) return invalid("no memory");
    impl->context->log_level_offset = kQuiet;
    impl->context->width = size.width;
    impl->context->height = size.height;
    impl->context->thread_count = 1;
    impl->context->err_recognition = AV_EF_EXPLODE;
    // as FFmpeg aligns them
    impl->context->max_pixels =
        static_cast<std::int64_t>(bytes_of({size.width + 256, size.height + 256}));
    impl->context->extradata = static_cast<std::uint8_t*>(
        av_mallocz(codec_data.size() + AV_INPUT_BUFFER_PADDING_SIZE));  // freed with the context
    if (impl->context->extradata == nullptr) return invalid("no memory");
    std::ranges::copy(codec_data, impl->context->extradata);
    impl->context->extradata_size = static_cast<int>(codec_data.size());
    if (const int error = avcodec_open2(impl->context.get(), found, nullptr); error < 0)
        return invalid(av_error_text(error));
    return SheetDecoder(std::move(impl));
}

Expected<void> SheetDecoder::decode(std::span<const std::uint8_t> coded,
                                    std::span<std::uint8_t> sheet) {
    assert(sheet.size() == bytes_of(impl_->size));
    const auto invalid = [](const std::string& reason) {
        return make_error(ErrorKind::kInvalidData, "cannot be decoded: " + reason);
    };
    AVPacket& packet = *impl_->packet;
    if (coded.size() > static_cast<std::size_t>(std::numeric_limits<int>::max() / 2) ||
        av_new_packet(&packet, static_cast<int>(coded.size())) < 0)
        return invalid("too long");
    std::ranges::copy(coded, packet.data);
    packet.flags |= AV_PKT_FLAG_KEY;
    const int sent = avcodec_send_packet(impl_->context.get(), &packet);
    av_packet_unref(&packet);
    if (sent < 0) return invalid(av_error_text(sent));
    if (const int error = impl_->receive(); error < 0) return invalid(av_error_text(error));
    const AVFrame& frame = *impl_->frame;
    if (frame.format != AV_PIX_FMT_GRAY8 || frame.width != impl_->size.width ||
        frame.height != impl_->size.height)
        return invalid("a picture of another size or format");
    for (int y = 0; y < frame.height; ++y) {
        std::copy_n(frame.data[0] + static_cast<std::ptrdiff_t>(y) * frame.linesize[0],
                    frame.width,
                    sheet.data() + static_cast<std::ptrdiff_t>(y) * frame.width);
    }
    av_frame_unref(impl_->frame.get());
    return {};
}

}  // namespace atrium::capture
