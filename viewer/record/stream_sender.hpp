#pragma once

#include "viewer/config/stream_address.hpp"
#include "viewer/record/stream_encoder.hpp"

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

struct AVCodecContext;

namespace atrium::viewer {

/// Sends encoded pictures on its own thread, and connects again, once a second, while the receiver
/// is away. `offer` never waits: at most kMostWaiting pictures wait, further ones are dropped up to
/// the next key picture. Thread-safe.
class StreamSender {
public:
    static constexpr std::size_t kMostWaiting = 60;

    /// Copies what it needs of `codec`.
    StreamSender(StreamTarget target, const AVCodecContext& codec);
    ~StreamSender();

    /// True while a receiver is connected, which is when pictures are worth encoding. For udp
    /// always.
    bool is_connected() const { return is_connected_; }
    /// True once after pictures were lost: the next one must be a key picture.
    bool wants_key() { return wants_key_.exchange(false); }
    void offer(EncodedPicture picture);

    std::uint64_t num_sent() const { return num_sent_; }
    std::uint64_t num_dropped() const { return num_dropped_; }
    std::uint64_t num_connections() const { return num_connections_; }
    /// Why there is no connection; empty while there is one.
    std::string problem() const;

private:
    struct Connection;
    void run(std::stop_token stop);
    void send(Connection& connection, std::stop_token stop);
    void report(const std::string& problem);
    void drop_all();

    StreamTarget target_;
    struct Codec;
    std::unique_ptr<Codec> codec_;
    std::atomic<bool> is_connected_ = false;
    std::atomic<bool> wants_key_ = false;
    std::atomic<std::uint64_t> num_sent_ = 0;
    std::atomic<std::uint64_t> num_dropped_ = 0;
    std::atomic<std::uint64_t> num_connections_ = 0;

    mutable std::mutex mutex_;  // guards the members below
    std::condition_variable_any offered_;
    std::deque<EncodedPicture> waiting_;
    bool needs_key_ = true;  // the receiver cannot decode other pictures
    std::string problem_;
    std::jthread thread_;  // last: stops before the other members are destroyed
};

}  // namespace atrium::viewer
