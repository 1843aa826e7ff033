#pragma once

#include "core/base/expected.hpp"
#include "viewer/config/viewer_config.hpp"
#include "viewer/control/start_view.hpp"
#include "viewer/overlay/annotations.hpp"
#include "viewer/pacing/drawing_times.hpp"
#include "viewer/receive/session.hpp"
#include "viewer/renderer/scene_renderer.hpp"
#include "viewer/scene/people_view.hpp"
#include "viewer/scene/scene_view.hpp"
#include "viewer/ui/display.hpp"
#include "viewer/ui/surface.hpp"

#include <chrono>
#include <limits>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

namespace atrium::viewer {

/// Draws the people and objects of a session, with annotations, for a display. Drawing thread only.
struct WorldPicture {
    using Clock = std::chrono::steady_clock;

    WorldPicture(const ViewerConfig& config, Display of)
        : display(std::move(of)), scene(config.models, display.delay()) {}

    /// Opens the surface, if `of` is null, and creates the renderer.
    Expected<void> open(const ViewerConfig& config,
                        const SurfaceOptions& options,
                        std::unique_ptr<Surface> of);
    /// Destroys the renderer and drops what it showed. Returns the surface.
    std::unique_ptr<Surface> close();

    /// Takes people and objects from the session, as they are to be shown at `now`.
    void update(Session& session, Clock::time_point now, DrawingTimes& times);
    /// Waits for the models and textures that are being read, for a picture that is written. Logs
    /// and returns false if that takes too long. `shown_at`: on a film's clock; empty: now.
    bool wait_for_files(const std::stop_token& stop,
                        std::optional<Clock::time_point> shown_at = std::nullopt);
    /// Draws what `update` took. `inside`: person through whose eyes the camera looks; empty:
    /// nobody. `now`: as for `update`.
    void draw(Session& session,
              const renderer::ViewCamera& camera,
              const std::string& inside,
              Clock::time_point now,
              DrawingTimes& times);
    std::vector<renderer::EyeView> eyes_of(const renderer::ViewCamera& camera) const {
        return display.eyes(camera, renderer->width(), renderer->height());
    }
    /// Width of the picture by its height.
    double aspect() const { return static_cast<double>(renderer->width()) / renderer->height(); }
    /// What may stand between an eye and people, as shown now; for the first viewpoint.
    Sight sight() const {
        return {[this](const Ray& ray) { return scene.free_m(ray); },
                [this](const Ray& ray) {
                    const auto loose = scene.pick(ray);
                    return loose ? loose->distance_m : std::numeric_limits<double>::infinity();
                },
                scene.is_complete(),
                scene.revision()};
    }
    /// Adopts the size of the surface.
    Expected<void> resize();

    Display display;
    std::unique_ptr<Surface> surface;
    std::optional<renderer::SceneRenderer> renderer;  // destroyed before its context, `surface`
    std::optional<Annotations> annotations;
    SceneView scene;
    PeopleView people;
    std::vector<renderer::EyeView> eyes;  // eyes of the last picture
};

}  // namespace atrium::viewer
