#pragma once

#include "tools/simulated_cameras/camera_server.hpp"
#include "tools/simulated_cameras/grey_notice.hpp"

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <vector>

// Keeps Aravis' types out of headers that others include.
typedef struct _ArvFakeCamera ArvFakeCamera;
typedef struct _ArvGvFakeCamera ArvGvFakeCamera;
typedef struct _ArvBuffer ArvBuffer;

namespace atrium::simulated_cameras {

/// State that all cameras of a server share.
struct SharedServerState {
    SharedServerState(ShownPictures shown_pictures, std::chrono::microseconds empty_time)
        : shown(std::move(shown_pictures)),
          schedule(shown.empty.front().size(), shown.num_instants(), shown.rig.rate_hz, empty_time),
          triggers(shown.rig.cameras.size()) {}

    const ShownPictures shown;
    ShowSchedule schedule;
    TriggerNumbers triggers;
    std::function<void()> on_picture;  // after each picture, on any camera's thread
};

struct CameraFaults {
    double lost_share = 0.0;
    std::chrono::nanoseconds delay{};
    std::chrono::nanoseconds clock_offset{};
};

/// One fake camera that can be switched off and on again.
class ServedCamera {
public:
    ServedCamera(std::size_t index,
                 CameraIdentity identity,
                 bool stamp,
                 const CameraFaults& faults,
                 SharedServerState& state);
    ~ServedCamera();
    ServedCamera(const ServedCamera&) = delete;
    ServedCamera& operator=(const ServedCamera&) = delete;

    /// Switches it on in its initial state. Error kUnavailable.
    Expected<void> start();
    /// Switches it off: clients get no answer.
    void stop();

    const CameraIdentity& identity() const { return identity_; }
    std::uint64_t num_sent() const { return num_sent_; }

private:
    void fill(ArvBuffer* buffer);
    TriggerNumbers::Trigger free_trigger(std::int64_t now_us, std::int64_t period_us);
    bool copy_region(const ShowSchedule::Choice& choice, ArvBuffer* buffer, std::uint8_t* out);
    bool hold_back(std::chrono::nanoseconds time);

    const std::size_t index_;
    const CameraIdentity identity_;
    const bool stamp_;
    const CameraFaults faults_;
    SharedServerState& state_;
    ArvGvFakeCamera* device_ = nullptr;
    ArvFakeCamera* registers_ = nullptr;  // of the device
    std::atomic<std::uint64_t> num_sent_{0};
    GreyNotice grey_;                             // of the camera's thread
    std::vector<std::uint8_t> rendered_picture_;  // likewise
    std::mutex mutex_;
    std::condition_variable wake_;
    bool is_leaving_ = false;
};

}  // namespace atrium::simulated_cameras
