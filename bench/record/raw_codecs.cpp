// Lossless codecs for the pictures of cameras: size and time of one picture on one thread, and
// whether the bytes come back. Writes comma-separated values, which raw_codecs.sh keeps.

#include "bench/median_ms.hpp"
#include "bench/scenes/site_scene.hpp"
#include "bench/value_of.hpp"
#include "site_node/capture/raw_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>
#include <vector>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/log.h>
#include <libavutil/opt.h>
}

namespace atrium::bench {
namespace {

using Bytes = std::vector<std::uint8_t>;

struct Candidate {
    const char* name;
    const char* encoder;
    std::array<std::array<const char*, 2>, 4> options{};
};

const Candidate kCandidates[] = {
    {"FFV1 Golomb",
     "ffv1",
     {{{"level", "3"}, {"coder", "0"}, {"context", "0"}, {"slicecrc", "0"}}}},
    {"FFV1 range", "ffv1", {{{"level", "3"}, {"coder", "1"}, {"context", "0"}, {"slicecrc", "0"}}}},
    {"FFV1 range large context",
     "ffv1",
     {{{"level", "3"}, {"coder", "1"}, {"context", "1"}, {"slicecrc", "0"}}}},
    {"HuffYUV left", "ffvhuff", {{{"pred", "left"}}}},
    {"HuffYUV left own tables", "ffvhuff", {{{"pred", "left"}, {"context", "1"}}}},
    {"HuffYUV median", "ffvhuff", {{{"pred", "median"}}}},
    {"MagicYUV left", "magicyuv", {{{"pred", "left"}}}},
    {"MagicYUV gradient", "magicyuv", {{{"pred", "gradient"}}}},
    {"MagicYUV median", "magicyuv", {{{"pred", "median"}}}},
    {"JPEG-LS", "jpegls", {}},
    {"H.264 lossless ultrafast",
     "libx264",
     {{{"preset", "ultrafast"}, {"qp", "0"}, {"tune", "zerolatency"}}}},
    {"H.264 lossless veryfast",
     "libx264",
     {{{"preset", "veryfast"}, {"qp", "0"}, {"tune", "zerolatency"}}}},
    {"PNG", "png", {{{"compression_level", "1"}, {"pred", "sub"}}}},
};

struct FreeContext {
    void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
};
struct FreeFrame {
    void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};
struct FreePacket {
    void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};
using Context = std::unique_ptr<AVCodecContext, FreeContext>;
using Frame = std::unique_ptr<AVFrame, FreeFrame>;
using Packet = std::unique_ptr<AVPacket, FreePacket>;

[[noreturn]] void give_up(const char* what) {
    fmt::print(stderr, "{} failed\n", what);
    std::exit(1);
}

// Null if this libavcodec lacks the encoder, or if it does not take grey pictures.
Context open_encoder(const Candidate& candidate, const capture::SheetSize& size) {
    const AVCodec* codec = avcodec_find_encoder_by_name(candidate.encoder);
    if (codec == nullptr) return nullptr;
    Context context(avcodec_alloc_context3(codec));
    context->width = size.width;
    context->height = size.height;
    context->pix_fmt = AV_PIX_FMT_GRAY8;
    context->color_range = AVCOL_RANGE_JPEG;
    context->time_base = {1, 30};
    context->gop_size = 1;
    context->thread_count = 1;
    for (const auto& [key, value] : candidate.options) {
        if (key != nullptr && av_opt_set(context.get(), key, value, AV_OPT_SEARCH_CHILDREN) < 0)
            give_up(key);
    }
    if (avcodec_open2(context.get(), codec, nullptr) < 0) return nullptr;
    return context;
}

Bytes encode(AVCodecContext& context, AVFrame& frame, AVPacket& packet) {
    frame.pts++;
    if (avcodec_send_frame(&context, &frame) < 0 || avcodec_receive_packet(&context, &packet) < 0)
        give_up("encoding");
    Bytes bytes(packet.data, packet.data + packet.size);
    av_packet_unref(&packet);
    return bytes;
}

Context open_decoder(const AVCodecContext& encoder) {
    const AVCodec* codec = avcodec_find_decoder(encoder.codec_id);
    Context context(avcodec_alloc_context3(codec));
    context->width = encoder.width;
    context->height = encoder.height;
    context->pix_fmt = encoder.pix_fmt;
    context->thread_count = 1;
    if (encoder.extradata_size > 0) {
        const auto bytes = static_cast<std::size_t>(encoder.extradata_size);
        context->extradata =
            static_cast<std::uint8_t*>(av_mallocz(bytes + AV_INPUT_BUFFER_PADDING_SIZE));
        std::copy_n(encoder.extradata, bytes, context->extradata);
        context->extradata_size = encoder.extradata_size;
    }
    if (avcodec_open2(context.get(), codec, nullptr) < 0) give_up("opening a decoder");
    return context;
}

bool decodes_to(AVCodecContext& context, const Bytes& coded, AVFrame& out, const Bytes& sheet) {
    const Packet packet(av_packet_alloc());
    if (av_new_packet(packet.get(), static_cast<int>(coded.size())) < 0) give_up("memory");
    std::copy(coded.begin(), coded.end(), packet->data);
    packet->flags |= AV_PKT_FLAG_KEY;
    if (avcodec_send_packet(&context, packet.get()) < 0) return false;
    if (avcodec_receive_frame(&context, &out) < 0) {
        avcodec_send_packet(&context, nullptr);
        if (avcodec_receive_frame(&context, &out) < 0) return false;
        avcodec_flush_buffers(&context);
    }
    for (int y = 0; y < out.height; ++y) {
        const auto width = static_cast<std::size_t>(out.width);
        if (!std::equal(&sheet[static_cast<std::size_t>(y) * width],
                        &sheet[static_cast<std::size_t>(y) * width] + width,
                        out.data[0] + y * out.linesize[0]))
            return false;
    }
    return true;
}

struct Result {
    double bytes = 0.0;
    double encode_ms = 0.0;
    double decode_ms = 0.0;
    bool is_lossless = true;
    int num = 0;
};

void measure(AVCodecContext& encoder,
             const capture::SheetSize& size,
             const Bytes& sheet,
             Result& sum) {
    const Frame frame(av_frame_alloc());
    frame->format = AV_PIX_FMT_GRAY8;
    frame->width = size.width;
    frame->height = size.height;
    if (av_frame_get_buffer(frame.get(), 0) < 0) give_up("memory");
    for (int y = 0; y < size.height; ++y)
        std::copy_n(&sheet[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width)],
                    size.width,
                    frame->data[0] + y * frame->linesize[0]);
    const Packet packet(av_packet_alloc());
    constexpr std::size_t kRepetitions = 5;
    Bytes coded;
    sum.encode_ms += median_ms(kRepetitions, [&] { coded = encode(encoder, *frame, *packet); });
    const Frame back(av_frame_alloc());
    sum.decode_ms += median_ms(kRepetitions, [&] {
        const Context decoder = open_decoder(encoder);
        sum.is_lossless &= decodes_to(*decoder, coded, *back, sheet);
    });
    sum.bytes += static_cast<double>(coded.size());
    ++sum.num;
}

void measure_scene(const SiteScene& scene, double noise) {
    for (const bool is_apart : {false, true}) {
        for (const Candidate& candidate : kCandidates) {
            Result sum;
            double raw = 0.0;
            for (std::size_t camera = 0; camera < scene.rig().cameras.size(); ++camera) {
                const image::RawImage& picture = scene.picture(3 * camera, camera);
                capture::RawLayout layout = capture::layout_of(picture);
                Bytes packed;
                capture::pack(picture, packed);
                if (!is_apart) layout.format = image::PixelFormat::kMono8;
                Bytes sheet(packed.size());
                capture::to_sheet(layout, packed, sheet);
                raw += static_cast<double>(packed.size());
                const capture::SheetSize size = capture::sheet_size(layout);
                const Context encoder = open_encoder(candidate, size);
                if (encoder == nullptr) break;
                measure(*encoder, size, sheet, sum);
            }
            if (sum.num == 0) continue;
            const double mb_per_s = raw / 1e3 / sum.encode_ms;
            fmt::print("{},{},{},{:.3f},{:.2f},{:.2f},{:.0f},{:.2f},{}\n",
                       noise,
                       candidate.name,
                       is_apart ? "colours apart" : "mosaic",
                       sum.bytes / raw,
                       sum.encode_ms / sum.num,
                       sum.decode_ms / sum.num,
                       mb_per_s,
                       240.0 / mb_per_s,
                       sum.is_lossless ? "yes" : "no");
        }
    }
}

}  // namespace
}  // namespace atrium::bench

int main() {
    using namespace atrium::bench;
    av_log_set_level(AV_LOG_QUIET);
    fmt::print(
        "noise_lsb,codec,arrangement,of_raw,encode_ms,decode_ms,mb_per_s,cores_for_8,lossless\n");
    for (const double noise : {1.0, 2.0, 6.0}) {
        SiteSceneOptions options;
        options.noise_lsb = noise;
        const auto scene = value_of(SiteScene::create(options));
        measure_scene(scene, noise);
    }
}
