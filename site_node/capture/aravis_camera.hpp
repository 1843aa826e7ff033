#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "site_node/capture/aravis_access.hpp"
#include "site_node/capture/aravis_stream.hpp"
#include "site_node/capture/camera_clock.hpp"
#include "site_node/capture/camera_counters.hpp"
#include "site_node/capture/frame_mailbox.hpp"
#include "site_node/capture/trigger_clock.hpp"

#include <condition_variable>
#include <functional>
#include <thread>

namespace atrium::capture {

/// Something that a person should know of a camera.
struct CameraEvent {
    bool is_warning = false;
    std::string text;  // one line, names the camera
};
using CameraEventSink = std::function<void(const CameraEvent&)>;  // called on any thread

/// What the cameras of one site share. Thread-safe; outlives them.
struct CameraCommons {
    CamerasOptions options;
    double rate_hz = 30.0;
    CameraEventSink tell;
    FrameMailbox mailbox;
    CameraFinder finder;
    std::mutex ptp_mutex;
    CameraClock ptp_clock;                         // one for all that follow the same master
    std::atomic<std::int64_t> last_picture_ns{0};  // of any camera, steady clock
    std::atomic<std::int64_t> least_delay_ns{
        std::numeric_limits<std::int64_t>::max()};  // of all cameras that the site triggers

    CameraCommons(const CamerasOptions& camera_options,
                  std::size_t num_cameras,
                  double rate,
                  CameraEventSink sink);
    std::chrono::nanoseconds period() const {
        return std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / rate_hz));
    }
};

/// One camera of the site: found, set up, watched, and taken back when it was gone, on a thread of
/// its own, so that no other camera ever waits for it. Its pictures go to the mailbox.
class AravisCamera final : StreamListener {
public:
    /// Starts looking for the camera. `index` is its place in the rig; `commons` outlives this.
    AravisCamera(std::size_t index,
                 const CameraEntry& entry,
                 const geometry::PinholeCamera& intrinsics,
                 CameraCommons& commons);
    ~AravisCamera() override;

    /// Waits until the first attempt to connect has ended, well or not. Error: why not, or
    /// kUnavailable where the stop came first.
    Expected<void> wait_for_first_attempt(std::stop_token stop);

    void request_stop() { keeper_.request_stop(); }

    /// Asks for one picture, where the trigger is ours: of the beat that is due at `due`. Never
    /// waits.
    void fire(std::chrono::steady_clock::time_point due);

    /// Thread-safe.
    CameraCounters counters() const;
    bool is_connected() const { return is_connected_; }
    /// False also where it has not answered its last trigger for so long that it will be lost.
    bool is_delivering() const { return is_connected_ && mute_time() < silence(); }
    void count_too_old(std::uint64_t num_pictures) { num_late_ += num_pictures; }

    const std::string& name() const { return entry_.name; }

private:
    struct Session;
    // What threads of Aravis may still use when this is gone.
    struct Wake {
        std::mutex mutex;
        std::condition_variable_any changed;
        std::optional<std::chrono::steady_clock::time_point> due;  // of the beat to be followed
        std::uint64_t lost_session = 0;                            // control of this one was lost
    };
    enum class End { kStopped, kLost, kSilent };

    void keep(std::stop_token stop);
    Expected<std::unique_ptr<Session>> connect(std::stop_token stop);
    void watch_control(Session& session);
    End serve(Session& session, std::stop_token stop);
    void trigger(Session& session, std::chrono::steady_clock::time_point due);
    void measure_delay(Session& session, std::stop_token stop);
    void tell_if_behind(std::chrono::nanoseconds delay);
    bool is_silent_for_good(Session& session);
    void close(std::unique_ptr<Session> session, End end);
    void say_connected(const Session& session, bool again);
    void finish_first_attempt(Expected<void> result);
    void tell(bool is_warning, const std::string& text) const;
    static std::int64_t now_ns();  // steady clock
    std::int64_t silence_ns() const;
    std::chrono::nanoseconds silence() const;    // that is a fault
    std::chrono::nanoseconds mute_time() const;  // since a trigger that was not answered yet
    bool may_be_judged(std::chrono::nanoseconds late) const;

    void on_picture(StreamPicture picture) override;
    void on_incomplete(std::uint64_t device_ns, Timestamp arrival) override;
    Timestamp time_on_site_clock(std::uint64_t device_ns, Timestamp arrival);
    bool is_triggered_by_site() const { return request_.trigger == TriggerMode::kSoftware; }
    void on_superseded() override { ++num_late_; }
    void note_sign_of_life();

    std::size_t index_;
    CameraEntry entry_;
    SetupRequest request_;
    CameraCommons& commons_;
    std::shared_ptr<Wake> wake_ = std::make_shared<Wake>();
    std::uint64_t session_number_ = 0;

    TriggerClock trigger_clock_;
    bool is_trigger_refused_ = false;        // the last one
    std::atomic<int> num_unanswered_{0};     // triggers since the last sign of life
    std::atomic<std::int64_t> asked_ns_{0};  // the trigger that is being sent; 0: none is
    bool is_told_mute_ = false;              // of the thread that calls `fire`
    bool is_told_behind_ = false;
    bool is_told_unmeasured_ = false;

    // of the receiving thread of the present session
    CameraClock clock_;
    BackwardsGuard guard_;
    std::atomic<bool> follows_ptp_{false};

    std::atomic<std::int64_t> last_sign_ns_{0};     // steady clock
    std::atomic<std::int64_t> last_picture_ns_{0};  // steady clock; 0: none came
    std::atomic<bool> is_connected_{false};
    std::atomic<std::uint64_t> num_received_{0};
    std::atomic<std::uint64_t> num_incomplete_{0};
    std::atomic<std::uint64_t> num_late_{0};
    std::atomic<std::uint64_t> num_backwards_{0};
    std::atomic<std::uint64_t> num_reconnects_{0};
    mutable std::mutex session_mutex_;
    AravisStream* stream_ = nullptr;  // of the present session, for its counts
    StreamCounts former_counts_;      // of all sessions before

    std::mutex first_mutex_;
    std::condition_variable_any first_changed_;
    std::optional<Expected<void>> first_result_;
    std::jthread keeper_;  // last: it uses all of the above
};

}  // namespace atrium::capture
