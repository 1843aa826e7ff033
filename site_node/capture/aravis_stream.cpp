#include "site_node/capture/aravis_stream.hpp"

#include "site_node/capture/network_interface.hpp"
#include "site_node/capture/packet_socket.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace atrium::capture {
namespace {

// IP, UDP and GVSP headers; included in the packet size.
constexpr std::size_t kPacketOverhead_bytes = 36;
// Opening the sockets takes milliseconds, but far longer on a loaded machine.
constexpr std::chrono::seconds kLongestOpening{2};

// Converts the Aravis count of packets that found no buffer to pictures.
std::uint64_t pictures_in(std::uint64_t num_packets, const CameraFormat& format) {
    const auto packet = static_cast<std::size_t>(std::max(format.packet_bytes, 0));
    if (packet <= kPacketOverhead_bytes) return num_packets;  // USB counts pictures
    const std::size_t data = packet - kPacketOverhead_bytes;
    const std::size_t per_picture =
        (format.payload_bytes + data - 1) / data + 2;  // plus leader and trailer
    return (num_packets + per_picture - 1) / per_picture;
}

}  // namespace

// Memory of the pictures. They may outlive the stream, and share ownership of this.
struct AravisStream::Buffers {
    std::mutex mutex;
    ArvStream* stream = nullptr;  // null: the stream is gone
    std::vector<std::unique_ptr<std::uint8_t[]>> memory;

    void give_back(ArvBuffer* buffer) {
        const std::lock_guard lock(mutex);
        if (stream != nullptr) {
            arv_stream_push_buffer(stream, buffer);
        } else {
            g_object_unref(buffer);
        }
    }

    // wide loads may read a few bytes past the end of a picture
    static constexpr std::size_t kSlack_bytes = 64;

    void add(std::size_t payload_bytes) {
        memory.push_back(
            std::make_unique<std::uint8_t[]>(payload_bytes + kSlack_bytes));  // touched: resident
        arv_stream_push_buffer(stream, arv_buffer_new(payload_bytes, memory.back().get()));
    }
};

AravisStream::AravisStream(const CameraFormat& format,
                           const StreamOptions& options,
                           StreamListener& listener)
    : format_(format),
      options_(options),
      listener_(&listener),
      buffers_(std::make_shared<Buffers>()) {}

Expected<std::unique_ptr<AravisStream>> AravisStream::create(ArvCamera& camera,
                                                             const CameraFormat& format,
                                                             const StreamOptions& options,
                                                             StreamListener& listener) {
    std::unique_ptr<AravisStream> self(new AravisStream(format, options, listener));
    if (arv_camera_is_gv_device(&camera)) {
        arv_camera_gv_set_stream_options(&camera,
                                         options.use_packet_socket
                                             ? ARV_GV_STREAM_OPTION_NONE
                                             : ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
    }
    GErrorSlot error;
    self->stream_.reset(arv_camera_create_stream(&camera, &on_event, self.get(), error.out()));
    if (self->stream_ == nullptr || error.failed()) {
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("cannot create the stream of pictures: {}", error.message()));
    }
    self->is_realtime_ = self->entered_.get_future().get();
    ArvStream* const stream = self->stream_.get();
    if (ARV_IS_GV_STREAM(stream)) {
        // time after the last packet: ends before the next picture, which then need not wait
        const auto retention_us = static_cast<guint>(
            std::clamp<std::int64_t>(options.period.count() / 2000, 2000, 1000000));
        g_object_set(stream,
                     "socket-buffer",
                     ARV_GV_STREAM_SOCKET_BUFFER_FIXED,  // its automatic size is too small
                     "socket-buffer-size",
                     static_cast<gint>(2 * format.payload_bytes),
                     "frame-retention",
                     retention_us,
                     "packet-timeout",
                     std::min(20000U, retention_us / 2),
                     nullptr);
        if (options.use_packet_socket && may_use_packet_sockets()) {
            const guint16 port = arv_gv_stream_get_port(ARV_GV_STREAM(stream));
            if (auto empty = wait_for_empty_packet_socket(port, kLongestOpening); !empty)
                return tl::unexpected(empty.error());
        }
    }
    const std::lock_guard lock(self->buffers_->mutex);
    self->buffers_->stream = stream;
    for (int i = 0; i < options.num_buffers; ++i) self->buffers_->add(format.payload_bytes);
    return self;
}

AravisStream::~AravisStream() {
    detach();
    {
        const std::lock_guard lock(buffers_->mutex);
        buffers_->stream = nullptr;
    }
    stream_.reset();  // joins its thread and drops the buffers in its queues
}

void AravisStream::detach() {
    const std::lock_guard lock(listener_mutex_);
    listener_ = nullptr;
}

StreamCounts AravisStream::counts() const {
    StreamCounts counts;
    guint64 unused = 0;
    guint64 underruns = 0;
    arv_stream_get_statistics(stream_.get(), &unused, &unused, &underruns);
    counts.num_without_buffer = pictures_in(underruns, format_);
    if (ARV_IS_GV_STREAM(stream_.get())) {
        guint64 resent = 0;
        arv_gv_stream_get_statistics(ARV_GV_STREAM(stream_.get()), &resent, &unused);
        counts.num_resent_packets = resent;
    }
    return counts;
}

void AravisStream::on_event(void* self, ArvStreamCallbackType type, ArvBuffer*) {
    auto* const stream = static_cast<AravisStream*>(self);
    if (type == ARV_STREAM_CALLBACK_TYPE_INIT) stream->enter_thread();
    if (type == ARV_STREAM_CALLBACK_TYPE_BUFFER_DONE) stream->drain();
}

void AravisStream::enter_thread() {
    pthread_setname_np(pthread_self(), options_.thread_name.c_str());
    sched_param param{};
    param.sched_priority = options_.realtime_priority;
    entered_.set_value(options_.realtime_priority > 0 &&
                       pthread_setschedparam(pthread_self(), SCHED_FIFO, &param) == 0);
}

// Empties the queue: passes on the newest whole picture and returns all other buffers.
void AravisStream::drain() {
    ArvStream* stream = nullptr;
    {
        const std::lock_guard lock(buffers_->mutex);
        stream = buffers_->stream;
    }
    if (stream == nullptr) return;  // being destroyed, and its queues with it
    const std::lock_guard lock(listener_mutex_);
    ArvBuffer* newest = nullptr;
    while (ArvBuffer* const buffer = arv_stream_try_pop_buffer(stream)) {
        const ArvBufferStatus status = arv_buffer_get_status(buffer);
        const bool is_whole = status == ARV_BUFFER_STATUS_SUCCESS && has_agreed_format(*buffer);
        ArvBuffer* const unused = is_whole ? std::exchange(newest, buffer) : buffer;
        if (unused == nullptr) continue;
        const bool is_left_over =
            status == ARV_BUFFER_STATUS_ABORTED || status == ARV_BUFFER_STATUS_CLEARED;
        if (listener_ != nullptr && is_whole) listener_->on_superseded();
        if (listener_ != nullptr && !is_whole && !is_left_over) report_incomplete(*buffer);
        buffers_->give_back(unused);
    }
    if (newest == nullptr) return;
    StreamPicture picture = picture_in(*newest);  // returns the buffer when it is released
    if (listener_ != nullptr) listener_->on_picture(std::move(picture));
}

void AravisStream::report_incomplete(ArvBuffer& buffer) {
    const auto arrival_ns = static_cast<std::int64_t>(arv_buffer_get_system_timestamp(&buffer));
    listener_->on_incomplete(arv_buffer_get_timestamp(&buffer), {arrival_ns});
}

bool AravisStream::has_agreed_format(ArvBuffer& buffer) const {
    const ArvBufferPayloadType type = arv_buffer_get_payload_type(&buffer);
    if (type != ARV_BUFFER_PAYLOAD_TYPE_IMAGE &&
        type != ARV_BUFFER_PAYLOAD_TYPE_EXTENDED_CHUNK_DATA) {
        return false;
    }
    int x_padding = 0;
    int y_padding = 0;
    arv_buffer_get_image_padding(&buffer, &x_padding, &y_padding);
    std::size_t num_bytes = 0;
    const void* const data = arv_buffer_get_image_data(&buffer, &num_bytes);
    const std::size_t stride = image::row_bytes(format_.format, format_.width) +
                               static_cast<std::size_t>(std::max(x_padding, 0));
    return data != nullptr && arv_buffer_get_image_width(&buffer) == format_.width &&
           arv_buffer_get_image_height(&buffer) == format_.height &&
           arv_buffer_get_image_pixel_format(&buffer) == format_.arv_format &&
           num_bytes + static_cast<std::size_t>(std::max(x_padding, 0)) >=
               stride * static_cast<std::size_t>(format_.height);
}

StreamPicture AravisStream::picture_in(ArvBuffer& buffer) const {
    int x_padding = 0;
    int y_padding = 0;
    arv_buffer_get_image_padding(&buffer, &x_padding, &y_padding);
    std::size_t num_bytes = 0;
    const void* const data = arv_buffer_get_image_data(&buffer, &num_bytes);
    StreamPicture picture;
    picture.device_ns = arv_buffer_get_timestamp(&buffer);
    picture.arrival = {static_cast<std::int64_t>(arv_buffer_get_system_timestamp(&buffer))};
    image::RawImage& image = picture.image;
    image.format = format_.format;
    image.width = format_.width;
    image.height = format_.height;
    image.planes[0] = {static_cast<const std::uint8_t*>(data),
                       image::row_bytes(format_.format, format_.width) +
                           static_cast<std::size_t>(std::max(x_padding, 0))};
    image.owner = std::shared_ptr<const void>(
        data, [buffers = buffers_, lent = &buffer](const void*) { buffers->give_back(lent); });
    return picture;
}

}  // namespace atrium::capture
