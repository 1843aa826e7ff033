#include "tests/unit/viewer/record/stream_receiver.hpp"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <optional>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

namespace atrium::viewer {

StreamReceiver::StreamReceiver(std::string url)
    : url_(std::move(url)), thread_([this] { receive(); }) {}

StreamReceiver::~StreamReceiver() { stop(); }

void StreamReceiver::stop() {
    is_over_ = true;
    if (thread_.joinable()) thread_.join();
}

std::vector<ReceivedPicture> StreamReceiver::take() {
    stop();
    return std::move(pictures_);
}

// Tries until the sender is there. Returns null if it is told to stop.
AVFormatContext* StreamReceiver::open() {
    while (!is_over_) {
        AVFormatContext* context = avformat_alloc_context();
        context->interrupt_callback = {
            [](void* self) { return static_cast<StreamReceiver*>(self)->is_over_ ? 1 : 0; }, this};
        // little to analyse, so that no picture waits for more data
        context->probesize = 32;
        context->max_analyze_duration = 0;
        context->flags |= AVFMT_FLAG_NOBUFFER;
        AVDictionary* options = nullptr;
        if (url_.starts_with("rtmp")) av_dict_set(&options, "listen", "1", 0);
        const int code = avformat_open_input(&context, url_.c_str(), nullptr, &options);
        av_dict_free(&options);
        if (code >= 0) return context;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return nullptr;
}

void StreamReceiver::receive() {
    AVFormatContext* context = open();
    if (context == nullptr) return;
    AVCodecContext* decoder = nullptr;
    AVPacket* packet = av_packet_alloc();
    AVFrame* frame = av_frame_alloc();
    std::optional<double> first_s;
    while (!is_over_ && av_read_frame(context, packet) >= 0) {
        const AVStream& stream = *context->streams[packet->stream_index];
        if (decoder == nullptr) {
            const AVCodec* codec = avcodec_find_decoder(stream.codecpar->codec_id);
            decoder = avcodec_alloc_context3(codec);
            avcodec_parameters_to_context(decoder, stream.codecpar);
            decoder->flags |= AV_CODEC_FLAG_LOW_DELAY;
            decoder->thread_count = 1;
            if (avcodec_open2(decoder, codec, nullptr) < 0) break;
        }
        avcodec_send_packet(decoder, packet);
        av_packet_unref(packet);
        while (avcodec_receive_frame(decoder, frame) >= 0) {
            const double time_s = static_cast<double>(frame->pts) * av_q2d(stream.time_base);
            if (!first_s) first_s = time_s;
            ReceivedPicture picture{time_s - *first_s, frame->width, frame->height, {}};
            for (int y = 0; y < frame->height; ++y) {
                const std::uint8_t* row =
                    frame->data[0] + static_cast<std::ptrdiff_t>(y) * frame->linesize[0];
                picture.luma.insert(picture.luma.end(), row, row + frame->width);
            }
            pictures_.push_back(std::move(picture));
            ++num_pictures_;
        }
    }
    avcodec_free_context(&decoder);
    av_frame_free(&frame);
    av_packet_free(&packet);
    avformat_close_input(&context);
}

int free_port() {
    const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    ::bind(descriptor, reinterpret_cast<sockaddr*>(&address), size);
    ::getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size);
    ::close(descriptor);
    return ntohs(address.sin_port);
}

}  // namespace atrium::viewer
