#pragma once

#include "viewer/record/stream_sender.hpp"
#include "viewer/record/video_file.hpp"

#include <chrono>
#include <memory>

namespace atrium::viewer {

/// A video for a receiver such as OBS, as it happens. `write` encodes and never waits for the
/// network; without a receiver it only counts time. A picture's time stamp is its slot, whatever
/// was dropped before it.
class LiveStream : public VideoFile {
public:
    /// Error kConfiguration if `url` is wrong; kUnavailable without an encoder for it. Whether
    /// anybody receives shows later: see `sender`.
    static Expected<std::unique_ptr<LiveStream>> create(const std::string& url,
                                                        const VideoFormat& format,
                                                        int kbps);
    Expected<void> set(std::span<const std::uint8_t> rgba) override;
    Expected<void> write() override;
    Expected<void> finish() override;

    const StreamSender& sender() const { return *sender_; }
    const StreamTarget& target() const { return target_; }

private:
    LiveStream() = default;

    StreamTarget target_;
    double fps_ = 30.0;
    std::unique_ptr<StreamEncoder> encoder_;
    std::unique_ptr<StreamSender> sender_;
    std::int64_t num_written_ = 0;
    std::chrono::steady_clock::time_point begin_;
    bool was_connected_ = false;
};

}  // namespace atrium::viewer
