#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "site_node/capture/aravis_access.hpp"
#include "site_node/capture/aravis_stream.hpp"
#include "site_node/capture/camera_clock.hpp"
#include "site_node/capture/camera_counters.hpp"
#include "site_node/capture/frame_mailbox.hpp"
#include "site_node/capture/trigger_clock.hpp"

#include <array>
#include <condition_variable>
#include <functional>
#include <thread>

namespace atrium::capture {

/// A camera event to show to the user.
struct CameraEvent {
    bool is_warning = false;
    std::string text;  // one line, names the camera
};
using CameraEventSink = std::function<void(const CameraEvent&)>;  // called on any thread

/// State that the cameras of one site share. Thread-safe. Must outlive them.
struct SharedCameraState {
    CamerasOptions options;
    double rate_hz = 30.0;
    CameraEventSink report;
    FrameMailbox mailbox;
    CameraFinder finder;
    std::mutex ptp_mutex;
    CameraClock ptp_clock;                         // shared by all cameras of one PTP master
    std::atomic<std::int64_t> last_picture_ns{0};  // of any camera, steady clock
    // smallest delay of all cameras that the site triggers
    std::atomic<std::int64_t> least_delay_ns{std::numeric_limits<std::int64_t>::max()};

    SharedCameraState(const CamerasOptions& camera_options,
                      std::size_t num_cameras,
                      double rate,
                      CameraEventSink sink);
    std::chrono::nanoseconds period() const {
        return std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / rate_hz));
    }
};

/// One camera of the site. Its own thread finds, sets up, watches and reconnects it, and no camera
/// ever waits for another. Its pictures go to the mailbox.
class AravisCamera final : StreamListener {
public:
    /// Starts to look for the camera. `index` is its place in the rig. `shared_state` must outlive
    /// this object.
    AravisCamera(std::size_t index,
                 const CameraEntry& entry,
                 const geometry::PinholeCamera& intrinsics,
                 SharedCameraState& shared_state);
    ~AravisCamera() override;

    /// Waits for the end of the first attempt to connect and returns its result; kUnavailable if
    /// the stop comes first.
    Expected<void> wait_for_first_attempt(std::stop_token stop);

    /// Width and height of the pictures [px], once the first attempt has succeeded.
    std::array<int, 2> size_px() const { return size_px_; }

    void request_stop() { thread_.request_stop(); }

    /// Requests one picture for the beat that is due at `due`. Only with software triggers. Never
    /// blocks.
    void fire(std::chrono::steady_clock::time_point due);

    /// Thread-safe.
    CameraCounters counters() const;
    bool is_connected() const { return is_connected_; }
    /// False also if the camera has left a trigger unanswered for so long that it counts as lost.
    bool is_delivering() const { return is_connected_ && unanswered_time() < silence(); }
    void count_too_old(std::uint64_t num_pictures) { num_late_ += num_pictures; }

    const std::string& name() const { return entry_.name; }

private:
    struct Session;
    // Threads of Aravis may still use this after the camera object is gone.
    struct Wake {
        std::mutex mutex;
        std::condition_variable_any changed;
        std::optional<std::chrono::steady_clock::time_point> due;  // of the beat to trigger
        std::uint64_t lost_session = 0;  // number of the session that lost control
    };
    enum class End { kStopped, kLost, kSilent };

    void run(std::stop_token stop);
    Expected<std::unique_ptr<Session>> connect(std::stop_token stop);
    void watch_control(Session& session);
    End serve(Session& session, std::stop_token stop);
    void trigger(Session& session, std::chrono::steady_clock::time_point due);
    void measure_delay(Session& session, std::stop_token stop);
    void report_if_behind(std::chrono::nanoseconds delay);
    bool is_silent_for_good(Session& session);
    void close(std::unique_ptr<Session> session, End end);
    void report_connected(const Session& session, bool again);
    void finish_first_attempt(Expected<void> result);
    void report(bool is_warning, const std::string& text) const;
    static std::int64_t now_ns();  // steady clock
    std::int64_t silence_ns() const;
    std::chrono::nanoseconds silence() const;          // that counts as a fault
    std::chrono::nanoseconds unanswered_time() const;  // since the trigger not yet acknowledged
    bool can_judge_silence(std::chrono::nanoseconds late) const;

    void on_picture(StreamPicture picture) override;
    void on_incomplete(std::uint64_t device_ns, Timestamp arrival) override;
    Timestamp time_on_site_clock(std::uint64_t device_ns, Timestamp arrival);
    bool is_triggered_by_site() const { return request_.trigger == TriggerMode::kSoftware; }
    void on_superseded() override { ++num_late_; }
    void note_sign_of_life();

    std::size_t index_;
    CameraEntry entry_;
    SetupRequest request_;
    SharedCameraState& shared_state_;
    std::shared_ptr<Wake> wake_ = std::make_shared<Wake>();
    std::uint64_t session_number_ = 0;
    std::array<int, 2> size_px_{};  // of the first session; not changed after

    TriggerClock trigger_clock_;
    bool is_trigger_refused_ = false;               // the latest one
    std::atomic<int> num_unanswered_{0};            // triggers since the last sign of life
    std::atomic<std::int64_t> trigger_sent_ns_{0};  // of the command in progress; 0: none
    bool is_unanswered_reported_ = false;           // only the thread that calls `fire` uses it
    bool is_behind_reported_ = false;
    bool is_unmeasured_reported_ = false;

    // used by the receiving thread of the current session
    CameraClock clock_;
    BackwardsGuard guard_;
    std::atomic<bool> follows_ptp_{false};

    std::atomic<std::int64_t> last_sign_ns_{0};     // steady clock
    std::atomic<std::int64_t> last_picture_ns_{0};  // steady clock; 0: no picture yet
    std::atomic<bool> is_connected_{false};
    std::atomic<std::uint64_t> num_received_{0};
    std::atomic<std::uint64_t> num_incomplete_{0};
    std::atomic<std::uint64_t> num_late_{0};
    std::atomic<std::uint64_t> num_backwards_{0};
    std::atomic<std::uint64_t> num_reconnects_{0};
    mutable std::mutex session_mutex_;
    AravisStream* stream_ = nullptr;  // of the current session, for its counts
    StreamCounts former_counts_;      // sum over all earlier sessions

    std::mutex first_mutex_;
    std::condition_variable_any first_changed_;
    std::optional<Expected<void>> first_result_;
    std::jthread thread_;  // last member: it uses all others
};

}  // namespace atrium::capture
