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
    std::chrono::nanoseconds period{};  // between two pictures
    int realtime_priority = 0;          // of the receiving thread; 0: none
    bool use_packet_socket = true;      // where permitted
    std::string thread_name;            // at most 15 characters
};

/// A picture as it came: `image` is memory of the stream, which is used again once its last owner
/// has let go.
struct StreamPicture {
    image::RawImage image;
    std::uint64_t device_ns = 0;  // the camera's time; 0: none
    Timestamp arrival;            // of the first packet
};

/// What a stream tells, on its receiving thread: nothing here may wait.
class StreamListener {
public:
    virtual ~StreamListener() = default;
    virtual void on_picture(StreamPicture picture) = 0;
    /// Packets of a picture are missing, or it is not as agreed. Its times may be those of an older
    /// one, where its first packet is among them.
    virtual void on_incomplete(std::uint64_t device_ns, Timestamp arrival) = 0;
    /// A whole picture was skipped, for a newer one was there.
    virtual void on_superseded() = 0;
};

struct StreamCounts {
    std::uint64_t num_resent_packets = 0;
    std::uint64_t num_without_buffer = 0;  // pictures
};

/// The pictures of one camera while it is connected. Aravis' thread receives them into memory of
/// ours and calls the listener; nothing is copied.
class AravisStream {
public:
    /// Makes the stream of a camera that was set up; pictures come once its acquisition is started.
    /// Error kUnavailable. `listener` must outlive the stream, or `detach` be called.
    static Expected<std::unique_ptr<AravisStream>> create(ArvCamera& camera,
                                                          const CameraFormat& format,
                                                          const StreamOptions& options,
                                                          StreamListener& listener);
    /// Waits for the receiving thread, for seconds where the camera no longer answers. Pictures
    /// that are in use stay valid.
    ~AravisStream();
    AravisStream(const AravisStream&) = delete;
    AravisStream& operator=(const AravisStream&) = delete;

    /// From now on the listener hears nothing.
    void detach();

    StreamCounts counts() const;

    /// True where the receiving thread was given its realtime priority.
    bool is_realtime() const { return is_realtime_; }

private:
    struct Buffers;
    AravisStream(const CameraFormat& format,
                 const StreamOptions& options,
                 StreamListener& listener);
    static void on_event(void* self, ArvStreamCallbackType type, ArvBuffer* buffer);
    void enter_thread();
    void drain();
    bool is_as_agreed(ArvBuffer& buffer) const;
    void tell_incomplete(ArvBuffer& buffer);
    StreamPicture picture_in(ArvBuffer& buffer) const;

    CameraFormat format_;
    StreamOptions options_;
    std::mutex listener_mutex_;
    StreamListener* listener_;  // null: detached
    std::shared_ptr<Buffers> buffers_;
    std::promise<bool> entered_;  // by the receiving thread: whether it got its priority
    bool is_realtime_ = false;
    GPtr<ArvStream> stream_;
};

}  // namespace atrium::capture
