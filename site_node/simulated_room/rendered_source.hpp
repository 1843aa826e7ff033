#pragma once

#include "simulation/rendered_room.hpp"
#include "simulation/wrong_cameras.hpp"
#include "site_node/capture/frame_source.hpp"

#include <memory>
#include <vector>

namespace atrium::simulated_room {

/// Shows a room for calibration in real time, without end. Renders each picture when it is due.
class RenderedSource final : public capture::FrameSource {
public:
    /// `room` has the cameras that `wrong` has instead of the rig's.
    RenderedSource(config::Rig rig,
                   std::unique_ptr<const simulation::RenderedRoom> room,
                   const simulation::WrongCameras& wrong);

    const config::Rig& rig() const override { return rig_; }
    bool has_silhouettes() const override { return false; }
    std::vector<Expected<void>> show_background(const std::vector<std::size_t>& cameras,
                                                const BackgroundSink& sink,
                                                std::stop_token stop) override;
    Expected<void> run(std::stop_token stop, const Sink& sink) override;
    /// Counts delivered pictures as received, lost ones as incomplete.
    std::vector<capture::CameraCounters> camera_counters() const override {
        return counters_.counters();
    }

private:
    config::Rig rig_;
    simulation::WrongCameras wrong_;
    capture::DeliveryCounters counters_;
    std::unique_ptr<const simulation::RenderedRoom> room_;
};

}  // namespace atrium::simulated_room
