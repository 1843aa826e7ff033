#pragma once

#include "core/base/expected.hpp"
#include "site_node/capture/frame_source.hpp"

#include <cstddef>
#include <filesystem>
#include <vector>

// Pictures for the benchmarks of the whole site.
namespace atrium::bench {

struct SiteSceneOptions {
    int side_px = 1000;                                        // pictures are square
    image::PixelFormat format = image::PixelFormat::kBayerRG;  // or kBgr
    double noise_lsb = 2.0;  // standard deviation of every sample of the sensor
    int num_instants = 24;   // of one second of motion; all stay in memory
    std::filesystem::path cache = ".cache/simulation";  // of the pictures without noise
};

/// A simulated person in front of eight cameras: raw pictures in memory, as the sensors deliver
/// them, each with its own noise. The benchmark then measures the site, and neither renderer nor
/// cameras.
class SiteScene final : public capture::FrameSource {
public:
    static Expected<SiteScene> create(const SiteSceneOptions& options);

    const config::Rig& rig() const override { return rig_; }
    bool has_silhouettes() const override { return false; }
    std::vector<Expected<void>> show_background(const std::vector<std::size_t>& cameras,
                                                const BackgroundSink& sink,
                                                std::stop_token stop) override;

    /// Plays the loop once, as fast as the sink takes it.
    Expected<void> run(std::stop_token stop, const Sink& sink) override;

    /// Picture of `camera` at any instant. The loop repeats for ever.
    const image::RawImage& picture(std::size_t instant, std::size_t camera) const {
        return frames_[instant % frames_.size()][camera];
    }

private:
    config::Rig rig_;
    std::vector<std::vector<image::RawImage>> empty_room_;  // [camera][shot]
    std::vector<std::vector<image::RawImage>> frames_;      // [instant][camera]
};

}  // namespace atrium::bench
