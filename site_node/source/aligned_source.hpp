#pragma once

#include "site_node/capture/frame_source.hpp"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace atrium::site_node {

/// Plays some cameras of a recording or of a simulated room for a site on several hosts: all of
/// them show instant n at n periods after the Unix epoch, by their clocks, as if one trigger fired
/// all cameras. Plays without end.
class AlignedSource final : public capture::FrameSource {
public:
    /// `cameras` are names; empty: all. Errors: kConfiguration if `source` has no such camera, or
    /// pictures that cannot be read in any order.
    static Expected<std::unique_ptr<AlignedSource>> create(
        std::unique_ptr<capture::FrameSource> source,
        const std::vector<std::string>& cameras,
        double rate_hz);

    /// Only of the chosen cameras.
    const config::Rig& rig() const override { return rig_; }
    bool has_silhouettes() const override { return source_->has_silhouettes(); }
    bool has_empty_room(std::size_t camera) const override {
        return source_->has_empty_room(chosen_[camera]);
    }
    std::filesystem::path learned_rooms() const override { return source_->learned_rooms(); }
    std::vector<Expected<void>> show_background(const std::vector<std::size_t>& cameras,
                                                const BackgroundSink& sink,
                                                std::stop_token stop) override;
    Expected<void> run(std::stop_token stop, const Sink& sink) override;
    std::size_t loop_length() const override { return source_->loop_length(); }
    Expected<capture::CameraFrame> read_picture(std::size_t camera, std::size_t index) override;
    std::vector<capture::CameraCounters> camera_counters() const override {
        return counters_.counters();
    }

private:
    AlignedSource(std::unique_ptr<capture::FrameSource> source,
                  std::vector<std::size_t> chosen,
                  config::Rig rig);
    Expected<capture::CameraFrame> decoded(std::size_t camera, std::size_t index);

    std::unique_ptr<capture::FrameSource> source_;
    std::vector<std::size_t> chosen_;  // of the source's cameras
    config::Rig rig_;
    capture::DeliveryCounters counters_;
    /// Short loops stay in memory: [index][camera].
    std::vector<std::vector<std::optional<capture::CameraFrame>>> kept_;
};

}  // namespace atrium::site_node
