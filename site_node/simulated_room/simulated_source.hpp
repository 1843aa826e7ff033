#pragma once

#include "simulation/changing_light.hpp"
#include "simulation/simulated_loop.hpp"
#include "simulation/wrong_cameras.hpp"
#include "site_node/capture/frame_source.hpp"

#include <filesystem>
#include <memory>

namespace atrium::simulated_room {

/// Plays a simulated room in real time. Its loop is rendered once or read from the cache, which
/// keeps the renderer out of all measurements.
class SimulatedSource final : public capture::FrameSource {
public:
    /// `room.rate_hz` is the rate of the source. An empty `cache` keeps nothing. The pictures are
    /// those of the cameras that `wrong` has instead of the rig's, in this light.
    static Expected<std::unique_ptr<SimulatedSource>> create(
        const config::Rig& rig,
        const simulation::RoomOptions& room,
        const std::filesystem::path& cache,
        const simulation::LoopProgress& progress,
        std::stop_token stop,
        const simulation::WrongCameras& wrong = {},
        const simulation::ChangingLight& light = {});

    const config::Rig& rig() const override { return rig_; }
    bool has_silhouettes() const override { return false; }
    std::vector<Expected<void>> show_background(const std::vector<std::size_t>& cameras,
                                                const BackgroundSink& sink,
                                                std::stop_token stop) override;
    Expected<void> run(std::stop_token stop, const Sink& sink) override;
    std::size_t loop_length() const override { return loop_.frames.size(); }
    /// With lights and cameras as at the first round.
    Expected<capture::CameraFrame> read_picture(std::size_t camera, std::size_t index) override;
    /// Counts delivered pictures as received.
    std::vector<capture::CameraCounters> camera_counters() const override {
        return counters_.counters();
    }

    /// Reason why the loop is not cached; empty if it is.
    const std::string& cache_problem() const { return cache_problem_; }
    /// The cache's file, if the room was rendered into it; else empty.
    const std::filesystem::path& cache_written() const { return cache_written_; }

private:
    SimulatedSource(config::Rig rig,
                    const simulation::WrongCameras& wrong,
                    const simulation::ChangingLight& light);
    config::Rig rig_;
    simulation::WrongCameras wrong_;
    simulation::ChangingLight light_;
    capture::DeliveryCounters counters_;
    simulation::SimulatedLoop loop_;  // of the cameras that are rendered
    std::string cache_problem_;
    std::filesystem::path cache_written_;
};

}  // namespace atrium::simulated_room
