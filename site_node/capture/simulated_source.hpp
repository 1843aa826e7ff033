#pragma once

#include "simulation/simulated_loop.hpp"
#include "site_node/capture/frame_source.hpp"

#include <filesystem>
#include <memory>

namespace atrium::capture {

/// A room that does not exist: its loop is rendered once, or taken from the cache, and then played
/// as if it were live, so that what is measured is the site and not the renderer.
class SimulatedSource final : public FrameSource {
public:
    /// `room.rate_hz` is the rate of the source. `cache` may be empty: nothing is kept.
    static Expected<std::unique_ptr<SimulatedSource>> create(
        const config::Rig& rig,
        const simulation::RoomOptions& room,
        const std::filesystem::path& cache,
        const simulation::LoopProgress& progress,
        std::stop_token stop);

    const config::Rig& rig() const override { return rig_; }
    bool has_silhouettes() const override { return false; }
    std::vector<Expected<void>> show_background(const std::vector<std::size_t>& cameras,
                                                const BackgroundSink& sink,
                                                std::stop_token stop) override;
    Expected<void> run(std::stop_token stop, const Sink& sink) override;
    /// Received is what was delivered.
    std::vector<CameraCounters> camera_counters() const override { return counters_.counters(); }

    /// What kept the loop out of the cache; empty where nothing did.
    const std::string& cache_problem() const { return cache_problem_; }

private:
    explicit SimulatedSource(config::Rig rig);
    config::Rig rig_;
    DeliveryCounters counters_;
    simulation::SimulatedLoop loop_;
    std::string cache_problem_;
};

}  // namespace atrium::capture
