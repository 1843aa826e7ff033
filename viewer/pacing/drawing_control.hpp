#pragma once

#include "core/base/expected.hpp"
#include "viewer/config/viewer_config.hpp"
#include "viewer/pacing/adaptive_quality.hpp"
#include "viewer/pacing/picture_pacer.hpp"
#include "viewer/receive/session.hpp"
#include "viewer/renderer/scene_renderer.hpp"

#include <chrono>
#include <span>
#include <stop_token>
#include <string>

namespace atrium::viewer {

/// Decides when the next picture begins and at which quality, and applies that to renderer and
/// decoding. Drawing thread only.
class DrawingControl {
public:
    using Clock = std::chrono::steady_clock;

    /// `display_hz`: refresh rate, 0 without a display. `is_tile`: part of a wall, which plays back
    /// with a delay. Session and renderer must outlive it.
    DrawingControl(const ViewConfig& view,
                   double display_hz,
                   bool is_tile,
                   Session& session,
                   renderer::SceneRenderer& renderer);

    /// Applies the quality. Fails if the renderer cannot change its resolution.
    Expected<void> apply();
    /// Blocks until the next picture is due. Returns false once a stop is requested.
    bool wait(const std::stop_token& stop);
    /// A picture that began at `at` has taken all people from the session.
    void began(Clock::time_point at);
    /// Changes the quality as the cost of the last picture requires, and logs that.
    Expected<void> adapt(const AdaptiveQuality::Picture& picture);
    /// Draws `eyes` of the last picture again if it was not at the best quality. Leaves the
    /// renderer at that quality.
    Expected<void> draw_at_best(std::span<const renderer::EyeView> eyes);

    const PictureQuality& quality() const { return adaptive_.quality(); }
    /// Description of a reduced quality. Empty at the best.
    std::string reduced_quality() const { return is_best() ? "" : describe(quality()); }

private:
    bool is_best() const { return adaptive_.level() == 0; }
    void note_arrivals();

    Session& session_;
    renderer::SceneRenderer& renderer_;
    bool adapts_;
    bool is_tile_;
    bool is_paced_by_display_;  // the display decides when a picture is shown
    PictureQuality best_;
    AdaptiveQuality adaptive_;
    PicturePacer pacer_;
};

}  // namespace atrium::viewer
