#pragma once

#include "simulation/wand_room.hpp"
#include "simulation/wrong_cameras.hpp"
#include "site_node/capture/frame_source.hpp"

#include <vector>

namespace atrium::simulated_room {

/// Shows a simulated sweep of a calibration wand in real time, without end. Renders each picture
/// when it is due.
class WandSource final : public capture::FrameSource {
public:
    /// The pictures are those of the cameras that `wrong` has instead of the rig's.
    WandSource(config::Rig rig,
               const simulation::WandRoomOptions& options,
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
    simulation::WandRoom room_;
};

}  // namespace atrium::simulated_room
