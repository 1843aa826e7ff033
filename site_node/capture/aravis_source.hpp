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
/// Each camera has a thread of its own that finds, sets up, watches and reconnects it, and one of
/// Aravis that receives its packets; with a software trigger one more keeps the beat. `run` hands
/// out the newest picture of each camera, and never one that has become old.
class AravisSource final : public FrameSource {
public:
    /// What a person should know, on any thread: `is_warning`, and one line that names the camera.
    using EventSink = std::function<void(bool is_warning, const std::string& line)>;

    /// Connects to the cameras. Those that are missing are looked for from then on, if at least
    /// `options.min_cameras` are there; else error kNotFound naming them. Error kConfiguration
    /// where entries and rig do not fit, or a camera refuses its settings. `rig.rate_hz` is the
    /// rate.
    static Expected<std::unique_ptr<AravisSource>> open(const config::Rig& rig,
                                                        const CamerasOptions& options,
                                                        EventSink events,
                                                        std::stop_token stop);
    ~AravisSource() override;

    const config::Rig& rig() const override { return rig_; }
    bool has_silhouettes() const override { return false; }
    bool is_live() const override { return true; }
    /// Shows what the cameras see now: the room has to be empty. kUnavailable for a camera that is
    /// not there for a second, or sends nothing for five.
    std::vector<Expected<void>> show_background(const std::vector<std::size_t>& cameras,
                                                const BackgroundSink& sink,
                                                std::stop_token stop) override;
    /// A picture that lacks packets, and those of a camera that is not connected, are frames
    /// without image.
    Expected<void> run(std::stop_token stop, const Sink& sink) override;
    std::vector<CameraCounters> camera_counters() const override;

private:
    struct Cameras;
    struct Showing;
    AravisSource(const config::Rig& rig, std::unique_ptr<Cameras> cameras);
    void tell_absent(Timestamp time, const Sink& sink);
    bool take(std::stop_token stop, std::vector<CameraFrame>& frames);
    bool is_silent_too_long(std::size_t camera,
                            std::chrono::steady_clock::time_point last_picture) const;

    config::Rig rig_;
    std::unique_ptr<Cameras> cameras_;
};

}  // namespace atrium::capture
