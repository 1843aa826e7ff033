#pragma once

#include "core/base/timestamp.hpp"
#include "site_node/capture/aravis_setup.hpp"

#include <chrono>
#include <future>
#include <memory>
#include <mutex>

namespace atrium::capture {

struct StreamOptions {
    int num_buffers = 8;
    std::chrono::nanoseconds period{};  // between pictures
    int realtime_priority = 0;          // of the receiving thread; 0: none
    bool use_packet_socket = true;      // if permitted
    std::string thread_name;            // at most 15 characters
};

/// A received picture. `image` is memory of the stream, reused once its last owner releases it.
struct StreamPicture {
    image::RawImage image;
    std::uint64_t device_ns = 0;  // camera clock; 0: no time
    Timestamp arrival;            // of the first packet
};

/// Callbacks of a stream, on its receiving thread. They must not block.
class StreamListener {
public:
    virtual ~StreamListener() = default;
    virtual void on_picture(StreamPicture picture) = 0;
    /// The picture lacks packets or does not match the format. If its first packet is missing, its
    /// times may be those of an older picture.
    virtual void on_incomplete(std::uint64_t device_ns, Timestamp arrival) = 0;
    /// A whole picture was skipped because a newer one was there.
    virtual void on_superseded() = 0;
};

struct StreamCounts {
    std::uint64_t num_resent_packets = 0;
    std::uint64_t num_without_buffer = 0;  // pictures
};

/// Receives the pictures of one connected camera. The Aravis thread writes them to our memory
/// without copies and calls the listener.
class AravisStream {
public:
    /// Creates the stream of a camera that is set up; pictures come once its acquisition starts.
    /// Error kUnavailable. `listener` must outlive the stream or the call of `detach`.
    static Expected<std::unique_ptr<AravisStream>> create(ArvCamera& camera,
                                                          const CameraFormat& format,
                                                          const StreamOptions& options,
                                                          StreamListener& listener);
    /// Waits for the receiving thread, for seconds if the camera no longer answers. Pictures in use
    /// stay valid.
    ~AravisStream();
    AravisStream(const AravisStream&) = delete;
    AravisStream& operator=(const AravisStream&) = delete;

    /// Ends all calls of the listener.
    void detach();

    StreamCounts counts() const;

    /// Returns true if the receiving thread got its real-time priority.
    bool is_realtime() const { return is_realtime_; }

private:
    struct Buffers;
    AravisStream(const CameraFormat& format,
                 const StreamOptions& options,
                 StreamListener& listener);
    static void on_event(void* self, ArvStreamCallbackType type, ArvBuffer* buffer);
    void enter_thread();
    void drain();
    bool has_agreed_format(ArvBuffer& buffer) const;
    void report_incomplete(ArvBuffer& buffer);
    StreamPicture picture_in(ArvBuffer& buffer) const;

    CameraFormat format_;
    StreamOptions options_;
    std::mutex listener_mutex_;
    StreamListener* listener_;  // null: detached
    std::shared_ptr<Buffers> buffers_;
    std::promise<bool> entered_;  // set by the receiving thread: whether it got its priority
    bool is_realtime_ = false;
    GPtr<ArvStream> stream_;
};

}  // namespace atrium::capture
