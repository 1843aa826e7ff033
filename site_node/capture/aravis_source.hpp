#pragma once

#include "site_node/capture/camera_counters.hpp"
#include "site_node/capture/camera_settings.hpp"
#include "site_node/capture/frame_source.hpp"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace atrium::capture {

/// GigE Vision and USB3 Vision cameras, through Aravis.
///
/// Each camera has two threads: its own finds, sets up, watches and reconnects it, and one of
/// Aravis receives its packets. With software triggers one more thread keeps the beat. `run`
/// delivers only the newest picture of each camera, and none older than the maximum age.
class AravisSource final : public FrameSource {
public:
    /// Receives events for the user, on any thread: `line` names the camera.
    using EventSink = std::function<void(bool is_warning, const std::string& line)>;

    /// Connects to the cameras. If at least `options.min_cameras` answer, the missing ones are
    /// searched for from then on; else error kNotFound with their names. Error kConfiguration if
    /// entries and rig do not match, or a camera refuses its settings. Triggers at `rig.rate_hz`.
    /// Cameras of the rig without a size send their whole sensors; then all must be there, and
    /// `rig()` has the sizes.
    static Expected<std::unique_ptr<AravisSource>> open(const config::Rig& rig,
                                                        const CamerasOptions& options,
                                                        EventSink events,
                                                        std::stop_token stop);
    ~AravisSource() override;

    const config::Rig& rig() const override { return rig_; }
    bool has_silhouettes() const override { return false; }
    bool is_live() const override { return true; }
    /// Shows what the cameras see now: the room must be empty. kUnavailable for a camera that is
    /// missing for one second, or sends nothing for five.
    std::vector<Expected<void>> show_background(const std::vector<std::size_t>& cameras,
                                                const BackgroundSink& sink,
                                                std::stop_token stop) override;
    /// A picture that lacks packets, or a camera that is not connected, gives a frame without
    /// image.
    Expected<void> run(std::stop_token stop, const Sink& sink) override;
    std::vector<CameraCounters> camera_counters() const override;

private:
    struct Cameras;
    struct Showing;
    AravisSource(const config::Rig& rig, std::unique_ptr<Cameras> cameras);
    void deliver_lost_frames(Timestamp time, const Sink& sink);
    bool take(std::stop_token stop, std::vector<CameraFrame>& frames);
    bool is_silent_too_long(std::size_t camera,
                            std::chrono::steady_clock::time_point last_picture) const;

    config::Rig rig_;
    std::unique_ptr<Cameras> cameras_;
};

}  // namespace atrium::capture
