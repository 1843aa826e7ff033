#include "site_node/capture/aravis_camera.hpp"

#include "site_node/capture/aravis_camera_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace atrium::capture {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using Clock = std::chrono::steady_clock;

constexpr milliseconds kFirstPause{100};  // between two attempts to connect; doubles each time
constexpr milliseconds kLongestPause{1000};
constexpr milliseconds kLeastSilence{500};  // shorter silence is never a fault
constexpr std::chrono::seconds kPtpCheckPeriod{1};
constexpr milliseconds kStall{100};  // longer than a thread usually waits for the processor
constexpr int kLeastUnanswered = 5;  // triggers before silence is a fault
// Buffers besides those that wait for a complete metaframe: one lacks packets, one is being
// received, one is next, one is in the mailbox, one waits for the pipeline and one is in it.
constexpr int kBuffersInFlight = 6;
constexpr int kMostBuffers = 32;

int num_buffers(const CamerasOptions& options, nanoseconds period) {
    if (options.num_buffers > 0) return options.num_buffers;
    const auto waiting = static_cast<int>((options.deadline + period - nanoseconds(1)) / period);
    return std::min(kBuffersInFlight + waiting, kMostBuffers);
}

}  // namespace

SharedCameraState::SharedCameraState(const CamerasOptions& camera_options,
                                     std::size_t num_cameras,
                                     double rate,
                                     CameraEventSink sink)
    : options(camera_options),
      rate_hz(rate),
      report(std::move(sink)),
      mailbox(num_cameras, camera_options.deadline + 2 * period()) {}

AravisCamera::AravisCamera(std::size_t index,
                           const CameraEntry& entry,
                           const geometry::PinholeCamera& intrinsics,
                           SharedCameraState& shared_state)
    : index_(index),
      entry_(entry),
      request_{merged(shared_state.options.common, entry.settings),
               shared_state.options.trigger,
               shared_state.rate_hz,
               intrinsics.width,
               intrinsics.height},
      shared_state_(shared_state),
      trigger_clock_(shared_state.period()),
      thread_([this](std::stop_token stop) { run(stop); }) {}

AravisCamera::~AravisCamera() = default;

void AravisCamera::report(bool is_warning, const std::string& text) const {
    shared_state_.report({is_warning, fmt::format("camera '{}' {}", entry_.name, text)});
}

void AravisCamera::finish_first_attempt(Expected<void> result) {
    {
        const std::lock_guard lock(first_mutex_);
        if (first_result_) return;
        first_result_ = std::move(result);
    }
    first_changed_.notify_all();
}

Expected<void> AravisCamera::wait_for_first_attempt(std::stop_token stop) {
    std::unique_lock lock(first_mutex_);
    if (!first_changed_.wait(lock, stop, [this] { return first_result_.has_value(); }))
        return make_error(ErrorKind::kUnavailable, "stopped");
    return *first_result_;
}

// Main function of this camera's thread: connects, serves until the camera is lost, starts over.
void AravisCamera::run(std::stop_token stop) {
    pthread_setname_np(pthread_self(), fmt::format("cam {:.11}", entry_.name).c_str());
    std::string last_problem;
    milliseconds pause = kFirstPause;
    bool was_connected = false;
    auto lost_at = Clock::now();
    while (!stop.stop_requested()) {
        auto session = connect(stop);
        if (!session) {
            finish_first_attempt(tl::unexpected(session.error()));
            if (session.error().message != last_problem)
                report(true, fmt::format("is not there: {}", session.error().message));
            last_problem = session.error().message;
            std::unique_lock lock(wake_->mutex);
            wake_->changed.wait_for(lock, stop, pause, [] { return false; });
            pause = std::min(2 * pause, kLongestPause);
            continue;
        }
        report_connected(**session, was_connected);
        if (was_connected) {
            ++num_reconnects_;
            report(false,
                   fmt::format("is back after {:.1f} s",
                               std::chrono::duration<double>(Clock::now() - lost_at).count()));
        }
        was_connected = true;
        last_problem.clear();
        pause = kFirstPause;
        if (size_px_[0] == 0) size_px_ = {(*session)->format.width, (*session)->format.height};
        finish_first_attempt({});
        const End end = serve(**session, stop);
        lost_at = Clock::now();
        close(std::move(*session), end);
    }
}

Expected<std::unique_ptr<AravisCamera::Session>> AravisCamera::connect(std::stop_token stop) {
    auto session = std::make_unique<Session>();
    auto found = shared_state_.finder.find(entry_.serial, entry_.address);
    if (!found) return tl::unexpected(found.error());
    session->found = std::move(*found);
    auto camera = open_camera(session->found);
    if (!camera) return tl::unexpected(camera.error());
    session->camera = std::move(*camera);
    session->number = ++session_number_;

    std::vector<std::string> warnings;
    auto format = set_up_camera(*session->camera, request_, warnings);
    if (!format) return tl::unexpected(format.error());
    session->format = *format;
    if (session_number_ == 1) {
        for (const std::string& warning : warnings) report(true, warning);
    }

    watch_control(*session);

    clock_ = {};
    guard_ = {};
    follows_ptp_ = false;
    if (is_triggered_by_site()) trigger_clock_.start_measuring();
    const CamerasOptions& options = shared_state_.options;
    auto stream = AravisStream::create(*session->camera,
                                       session->format,
                                       {num_buffers(options, shared_state_.period()),
                                        shared_state_.period(),
                                        options.realtime_priority,
                                        options.use_packet_socket,
                                        fmt::format("rx {:.12}", entry_.name)},
                                       *this);
    if (!stream) return tl::unexpected(stream.error());
    session->stream = std::move(*stream);
    GErrorSlot error;
    arv_camera_start_acquisition(session->camera.get(), error.out());
    if (error.failed()) {
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("it does not start the acquisition: {}", error.message()));
    }
    if (is_triggered_by_site()) measure_delay(*session, stop);
    note_sign_of_life();
    is_trigger_refused_ = false;
    is_connected_ = true;
    const std::lock_guard lock(session_mutex_);
    stream_ = session->stream.get();
    return session;
}

// Aravis may still run the handler while this object is destroyed: it shares ownership of its data.
void AravisCamera::watch_control(Session& session) {
    using Lost = std::pair<std::shared_ptr<Wake>, std::uint64_t>;
    static std::mutex mutex;  // guards data that passes through GLib, whose locks no sanitizer sees
    const std::lock_guard lock(mutex);
    session.lost_handler = g_signal_connect_data(
        arv_camera_get_device(session.camera.get()),
        "control-lost",
        G_CALLBACK(+[](ArvDevice*, Lost* data) {
            std::unique_lock handed_over(mutex);
            const Lost lost = *data;
            handed_over.unlock();
            {
                const std::lock_guard wake_lock(lost.first->mutex);
                lost.first->lost_session = lost.second;
            }
            lost.first->changed.notify_one();
        }),
        new Lost(wake_, session.number),
        [](gpointer lost, GClosure*) { delete static_cast<Lost*>(lost); },
        G_CONNECT_DEFAULT);
}

void AravisCamera::report_connected(const Session& session, bool again) {
    const auto delay = trigger_clock_.delay();
    report(false,
           fmt::format(
               "connected vendor=\"{}\" model=\"{}\" serial={} address={} size={}x{} "
               "format={} packet_bytes={}{}",
               session.found.vendor,
               session.found.model,
               session.found.serial,
               session.found.address,
               session.format.width,
               session.format.height,
               arv_camera_get_pixel_format_as_string(session.camera.get(), nullptr),
               session.format.packet_bytes,
               delay ? fmt::format(" delay_ms={:.1f}", static_cast<double>(delay->count()) * 1e-6)
                     : std::string()));
    if (again || shared_state_.options.realtime_priority <= 0 || session.stream->is_realtime())
        return;
    report(false,
           "is received without real-time priority, which is not permitted here (atrium doctor)");
}

nanoseconds AravisCamera::silence() const {
    return std::max<nanoseconds>(shared_state_.options.silent_periods * shared_state_.period(),
                                 kLeastSilence);
}

// Triggers and watches the camera until it is lost or the stop comes.
AravisCamera::End AravisCamera::serve(Session& session, std::stop_token stop) {
    const nanoseconds silence = this->silence();
    auto next_check = Clock::now() + silence;
    auto next_ptp_check = Clock::now();
    while (true) {
        std::optional<Clock::time_point> due;
        {
            const auto until =
                session.format.has_ptp ? std::min(next_check, next_ptp_check) : next_check;
            std::unique_lock lock(wake_->mutex);
            wake_->changed.wait_until(lock, stop, until, [&] {
                return wake_->due || wake_->lost_session == session.number;
            });
            if (stop.stop_requested()) return End::kStopped;
            if (wake_->lost_session == session.number) return End::kLost;
            due = std::exchange(wake_->due, std::nullopt);
        }
        if (due) trigger(session, *due);
        if (trigger_clock_.needs_measuring()) measure_delay(session, stop);
        const auto now = Clock::now();
        if (session.format.has_ptp && now >= next_ptp_check) {
            follows_ptp_ = is_ptp_locked(*session.camera);
            next_ptp_check = now + kPtpCheckPeriod;
        }
        if (now < next_check) continue;
        const nanoseconds quiet(silence_ns());
        const bool is_quiet = quiet >= silence && can_judge_silence(now - next_check);
        if (is_quiet && is_silent_for_good(session)) return End::kSilent;
        next_check = Clock::now() + (is_quiet           ? silence
                                     : quiet >= silence ? silence / 2
                                                        : silence - quiet);
    }
}

// If this thread had to wait for the processor, the receiving thread may have waited too. And
// skipped triggers leave no picture to miss.
bool AravisCamera::can_judge_silence(nanoseconds late) const {
    if (is_trigger_refused_) return true;
    if (is_triggered_by_site() && num_unanswered_ < kLeastUnanswered) return false;
    return late < kStall;
}

// An external trigger may pause: then all cameras are silent.
bool AravisCamera::is_silent_for_good(Session& session) {
    const bool others_deliver = shared_state_.last_picture_ns > last_sign_ns_;
    if (request_.trigger != TriggerMode::kExternal || others_deliver || !session.answers() ||
        !is_under_control(*session.camera)) {
        return true;
    }
    if (!std::exchange(session.is_untriggered, true))
        report(true, "is under control and sends nothing, like all others: is it triggered?");
    return false;
}

void AravisCamera::close(std::unique_ptr<Session> session, End end) {
    is_connected_ = false;
    session->stream->detach();
    shared_state_.mailbox.clear(index_);
    {
        const std::lock_guard lock(session_mutex_);
        const StreamCounts counts = stream_->counts();
        former_counts_.num_resent_packets += counts.num_resent_packets;
        former_counts_.num_without_buffer += counts.num_without_buffer;
        stream_ = nullptr;
    }
    if (end != End::kStopped) {
        report(
            true,
            fmt::format("is lost: {}; looking for it",
                        end == End::kLost ? "it is no longer under control"
                                          : fmt::format("no picture for {:.1f} s",
                                                        static_cast<double>(silence_ns()) * 1e-9)));
    }
    if (!session->answers()) {
        release_in_background(std::shared_ptr<Session>(std::move(session)));
        return;
    }
    GErrorSlot error;
    arv_camera_stop_acquisition(session->camera.get(), error.out());
}

}  // namespace atrium::capture
