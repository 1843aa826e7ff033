#include "viewer/record/stream_sender.hpp"

#include "core/app/log.hpp"

#include <fmt/format.h>
#include <pthread.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <optional>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/dict.h>
}

namespace atrium::viewer {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kWaits = "waits for a receiver";
constexpr auto kRetry = std::chrono::seconds(1);
// A receiver that takes nothing for this time is lost.
constexpr auto kPatience = std::chrono::seconds(5);

std::string text_of(int code) {
    std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
    av_strerror(code, text.data(), text.size());
    return text.data();
}

}  // namespace

struct StreamSender::Codec {
    AVCodecParameters* parameters = avcodec_parameters_alloc();
    AVRational period{1, 30};
    Codec() = default;
    Codec(const Codec&) = delete;
    Codec& operator=(const Codec&) = delete;
    ~Codec() { avcodec_parameters_free(&parameters); }
};

// An open container on an open connection. The interrupt callback ends every wait of libavformat.
struct StreamSender::Connection {
    Connection(const StreamTarget& target, const Codec& codec, std::stop_token stop)
        : target_(target), codec_(codec), stop_(std::move(stop)) {}
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;
    ~Connection() {
        av_packet_free(&packet_);
        if (context_ == nullptr) return;
        limit_ = Clock::now() + std::chrono::milliseconds(200);
        if (has_header_) av_write_trailer(context_);
        avio_closep(&context_->pb);
        avformat_free_context(context_);
    }

    // Returns libavformat's code.
    int open() {
        int code = avformat_alloc_output_context2(
            &context_, nullptr, target_.format.c_str(), target_.url.c_str());
        if (code < 0) return code;
        context_->interrupt_callback = {
            [](void* self) { return static_cast<Connection*>(self)->is_over() ? 1 : 0; }, this};
        context_->max_delay = 0;
        context_->flush_packets = 1;
        stream_ = avformat_new_stream(context_, nullptr);
        if (stream_ == nullptr) return AVERROR(ENOMEM);
        code = avcodec_parameters_copy(stream_->codecpar, codec_.parameters);
        if (code < 0) return code;
        stream_->codecpar->codec_tag = 0;
        stream_->time_base = codec_.period;
        stream_->avg_frame_rate = {codec_.period.den, codec_.period.num};
        // waiting for a receiver has no limit but the end of the program
        if (!target_.waits_for_receiver) limit_ = Clock::now() + kPatience;
        code = avio_open2(&context_->pb,
                          target_.url.c_str(),
                          AVIO_FLAG_WRITE,
                          &context_->interrupt_callback,
                          nullptr);
        if (code < 0) return code;
        limit_ = Clock::now() + kPatience;
        AVDictionary* options = nullptr;
        av_dict_set(&options, "flvflags", "no_duration_filesize", 0);  // only flv knows it
        code = avformat_write_header(context_, &options);
        av_dict_free(&options);
        has_header_ = code >= 0;
        return code;
    }

    int write(EncodedPicture& picture) {
        if (!first_) first_ = picture.index;
        packet_->data = picture.bytes.data();
        packet_->size = static_cast<int>(picture.bytes.size());
        packet_->pts = packet_->dts = picture.index - *first_;
        packet_->duration = 1;
        packet_->stream_index = stream_->index;
        packet_->flags = picture.is_key ? AV_PKT_FLAG_KEY : 0;
        av_packet_rescale_ts(packet_, codec_.period, stream_->time_base);
        limit_ = Clock::now() + kPatience;
        return av_write_frame(context_, packet_);
    }

private:
    bool is_over() const { return stop_.stop_requested() || (limit_ && Clock::now() > *limit_); }

    const StreamTarget& target_;
    const Codec& codec_;
    std::stop_token stop_;
    std::optional<Clock::time_point> limit_;
    AVFormatContext* context_ = nullptr;
    AVStream* stream_ = nullptr;  // owned by `context_`
    AVPacket* packet_ = av_packet_alloc();
    bool has_header_ = false;
    std::optional<std::int64_t> first_;
};

StreamSender::StreamSender(StreamTarget target, const AVCodecContext& codec)
    : target_(std::move(target)), codec_(std::make_unique<Codec>()) {
    avcodec_parameters_from_context(codec_->parameters, &codec);
    codec_->period = codec.time_base;
    thread_ = std::jthread([this](std::stop_token stop) { run(std::move(stop)); });
    pthread_setname_np(thread_.native_handle(), "stream");
}

StreamSender::~StreamSender() = default;

std::string StreamSender::problem() const {
    const std::lock_guard lock(mutex_);
    return problem_;
}

void StreamSender::offer(EncodedPicture picture) {
    {
        const std::lock_guard lock(mutex_);
        const bool is_full = waiting_.size() >= kMostWaiting;
        if (!is_connected_ || is_full || (needs_key_ && !picture.is_key)) {
            ++num_dropped_;
            needs_key_ = true;
            if (!is_full) wants_key_ = true;
            return;
        }
        needs_key_ = false;
        waiting_.push_back(std::move(picture));
    }
    offered_.notify_one();
}

void StreamSender::report(const std::string& problem) {
    {
        const std::lock_guard lock(mutex_);
        if (problem_ == problem) return;
        problem_ = problem;
    }
    if (problem == kWaits) {
        app::log::info("stream_waits to={} for a receiver", target_.shown);
    } else if (!problem.empty()) {
        app::log::warn("stream_off to={} reason=\"{}\"; connects again", target_.shown, problem);
    }
}

void StreamSender::drop_all() {
    const std::lock_guard lock(mutex_);
    num_dropped_ += waiting_.size();
    waiting_.clear();
    needs_key_ = true;
    wants_key_ = true;
}

void StreamSender::run(std::stop_token stop) {
    while (!stop.stop_requested()) {
        const auto begin = Clock::now();
        Connection connection(target_, *codec_, stop);
        if (target_.waits_for_receiver) report(kWaits);
        const int code = connection.open();
        if (code >= 0) {
            drop_all();
            is_connected_ = true;
            ++num_connections_;
            report("");
            app::log::info("stream_on to={}", target_.shown);
            send(connection, stop);
            is_connected_ = false;
            drop_all();
        } else if (!stop.stop_requested()) {
            // srt reports EIO for everything
            const bool is_silent = code == AVERROR_EXIT || code == AVERROR(EIO);
            report(is_silent ? "no answer" : text_of(code));
        }
        std::unique_lock lock(mutex_);
        offered_.wait_until(lock, stop, begin + kRetry, [] { return false; });
    }
}

void StreamSender::send(Connection& connection, std::stop_token stop) {
    for (;;) {
        EncodedPicture picture;
        {
            std::unique_lock lock(mutex_);
            if (!offered_.wait(lock, stop, [this] { return !waiting_.empty(); })) return;
            picture = std::move(waiting_.front());
            waiting_.pop_front();
        }
        const int code = connection.write(picture);
        if (code < 0) {
            ++num_dropped_;
            if (!stop.stop_requested())
                report(code == AVERROR_EXIT   ? "the receiver takes no pictures"
                       : code == AVERROR(EIO) ? "the receiver is gone"
                                              : text_of(code));
            return;
        }
        ++num_sent_;
    }
}

}  // namespace atrium::viewer
