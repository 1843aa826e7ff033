#pragma once

#include "core/app/log.hpp"
#include "viewer/picture_file.hpp"
#include "viewer/renderer/scene_renderer.hpp"
#include "viewer/viewer_config.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace atrium::viewer {

/// What is kept of the pictures: screenshots, videos and the last one. Of the drawing thread; a
/// renderer's context has to be current.
class Album {
public:
    explicit Album(const ViewerConfig& config) : config_(config) {}

    /// Makes the files ready that the configuration asks for; error kUnavailable where one cannot
    /// be written.
    Expected<void> open(const renderer::SceneRenderer& renderer);
    /// Finishes the video; error kUnavailable where it is not whole.
    Expected<void> close();

    /// Offers the picture that was just drawn to the video; to the one that the configuration asks
    /// for only if it `counts`, see RunLimit.
    void add(const renderer::SceneRenderer& renderer, bool counts);
    /// How long the video is by now [s]; nothing: none is recorded.
    std::optional<double> video_s() const;
    /// Pictures that videos repeat the one before for, as encoding could not keep up.
    std::uint64_t num_dropped() const {
        return num_dropped_before_ + (video_ ? video_->num_dropped() : 0);
    }

    // For people who press keys: return what became of it, to be read.
    std::string toggle_video(const renderer::SceneRenderer& renderer);
    std::string screenshot(const renderer::SceneRenderer& renderer);

    /// The last picture, where the configuration asks for it.
    Expected<void> write_output(const renderer::SceneRenderer& renderer);

private:
    Expected<void> begin_video(const std::filesystem::path& file,
                               const renderer::SceneRenderer& renderer);
    std::filesystem::path next_file(const std::string& extension);

    const ViewerConfig& config_;
    std::unique_ptr<VideoRecorder> video_;
    std::filesystem::path video_file_;
    bool is_asked_for_ = false;             // the video, by the configuration
    std::uint64_t num_dropped_before_ = 0;  // by the videos before
    app::log::OncePerSecond drops_;
    renderer::RenderedPicture picture_;
    int num_files_ = 0;
};

}  // namespace atrium::viewer
