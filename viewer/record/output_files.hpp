#pragma once

#include "core/app/log.hpp"
#include "viewer/config/viewer_config.hpp"
#include "viewer/record/live_outputs.hpp"
#include "viewer/record/video_recorder.hpp"
#include "viewer/renderer/scene_renderer.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace atrium::viewer {

/// Checks, before a window opens, that the files of the configuration can be written, and makes
/// their folders. Error kUnavailable. A default folder of screenshots that cannot be written is a
/// warning: most runs make none.
Expected<void> check_outputs(const ViewerConfig& config);

/// Writes screenshots, videos and the last picture. Drawing thread only; the renderer's context
/// must be current.
class OutputFiles {
public:
    explicit OutputFiles(const ViewerConfig& config) : config_(config), live_(config) {}

    /// Opens the files, stream and virtual camera that the configuration names. Error kUnavailable
    /// if one cannot be written.
    Expected<void> open(const renderer::SceneRenderer& renderer);
    /// Finishes the video and ends the stream. Error kUnavailable if the video is incomplete.
    Expected<void> close();

    /// Offers the picture just drawn to the running video. The video of the configuration takes it
    /// only if it `counts` (see RunLimit).
    void add(const renderer::SceneRenderer& renderer, bool counts);
    /// Length of the running video [s]. Empty if none is recorded.
    std::optional<double> video_s() const;
    /// Pictures that the encoder was too slow for. The videos repeat the picture before instead.
    std::uint64_t num_dropped() const {
        return num_dropped_before_ + (video_ ? video_->num_dropped() : 0) + live_.num_dropped();
    }
    /// Stream and virtual camera, for the panel; empty: none runs.
    std::string live() const { return live_.description(); }

    // Handle key presses. Return a message for the user.
    std::string toggle_video(const renderer::SceneRenderer& renderer);
    std::string toggle_stream(const renderer::SceneRenderer& renderer) {
        return live_.toggle(renderer);
    }
    std::string screenshot(const renderer::SceneRenderer& renderer);

    /// Writes the current picture to the file that the configuration names, if it names one.
    Expected<void> write_output(const renderer::SceneRenderer& renderer);

private:
    Expected<void> begin_video(const std::filesystem::path& file,
                               const renderer::SceneRenderer& renderer);
    std::filesystem::path next_file(const std::string& extension) const;

    Expected<void> close_video();

    const ViewerConfig& config_;
    LiveOutputs live_;
    std::unique_ptr<VideoRecorder> video_;
    std::filesystem::path video_file_;
    bool is_asked_for_ = false;             // the configuration asked for this video
    std::uint64_t num_dropped_before_ = 0;  // of earlier videos
    app::log::OncePerSecond drops_;
    renderer::RenderedPicture picture_;
};

}  // namespace atrium::viewer
