#pragma once

#include "viewer/config/viewer_config.hpp"
#include "viewer/record/live_stream.hpp"
#include "viewer/record/video_recorder.hpp"
#include "viewer/record/virtual_camera.hpp"
#include "viewer/renderer/scene_renderer.hpp"

#include <cstdint>
#include <memory>
#include <string>

namespace atrium::viewer {

/// The stream and the virtual camera of the viewer. Drawing thread only; the renderer's context
/// must be current.
class LiveOutputs {
public:
    explicit LiveOutputs(const ViewerConfig& config) : config_(config) {}

    /// Begins what the configuration names. Errors kConfiguration, kUnavailable: no encoder, or no
    /// usable device. A receiver that does not answer is no error.
    Expected<void> open(const renderer::SceneRenderer& renderer);
    void close();

    /// Offers the picture just drawn.
    void add(const renderer::SceneRenderer& renderer);
    /// Handles a key press: ends what runs, or begins it. Returns a message for the user.
    std::string toggle(const renderer::SceneRenderer& renderer);

    /// For the panel, such as "stream to srt://host:9000: 12.3 s, F10: stop"; empty: nothing runs.
    std::string description() const;
    /// Pictures that a receiver or device missed while it was there.
    std::uint64_t num_dropped() const;

private:
    struct Output {
        std::unique_ptr<VideoRecorder> recorder;
        double fps = 1.0;
        double length_s() const { return static_cast<double>(recorder->num_written()) / fps; }
    };
    Expected<void> open_stream(const VideoFormat& format);
    Expected<void> open_camera(const VideoFormat& format);
    bool is_running() const { return stream_.recorder != nullptr || camera_.recorder != nullptr; }
    std::uint64_t num_dropped_now() const;

    const ViewerConfig& config_;
    Output stream_;
    Output camera_;
    const LiveStream* stream_target_ = nullptr;     // owned by `stream_`
    const VirtualCamera* camera_target_ = nullptr;  // owned by `camera_`
    std::uint64_t num_dropped_before_ = 0;          // of those that ended
};

}  // namespace atrium::viewer
