#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

struct AVFormatContext;

namespace atrium::viewer {

/// A picture as a receiver decodes it.
struct ReceivedPicture {
    double time_s = 0.0;  // its time stamp, from that of the first picture on
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> luma;
};

/// Receives a stream with libavformat on its own thread, as OBS does, until it ends or `stop`.
class StreamReceiver {
public:
    explicit StreamReceiver(std::string url);
    ~StreamReceiver();
    StreamReceiver(const StreamReceiver&) = delete;
    StreamReceiver& operator=(const StreamReceiver&) = delete;

    std::size_t num_pictures() const { return num_pictures_; }
    /// Ends the connection.
    void stop();
    /// Ends the connection. The pictures in order.
    std::vector<ReceivedPicture> take();

private:
    AVFormatContext* open();
    void receive();

    std::string url_;
    std::atomic<std::size_t> num_pictures_ = 0;
    std::atomic<bool> is_over_ = false;
    std::vector<ReceivedPicture> pictures_;  // the thread's until it ends
    std::thread thread_;
};

/// A TCP or UDP port that was free a moment ago.
int free_port();

}  // namespace atrium::viewer
