#include "viewer/ui/world_picture.hpp"

#include "core/app/log.hpp"

#include <chrono>
#include <cmath>
#include <thread>

namespace atrium::viewer {
namespace {

// Tells the decoders whose textures the eyes need. The silhouettes of the debug view need all.
void set_decoder_eyes(Session& session,
                      const std::vector<renderer::EyeView>& eyes,
                      bool has_silhouettes) {
    std::vector<Eigen::Vector3d> eyes_world;
    if (!has_silhouettes)
        for (const renderer::EyeView& eye : eyes) eyes_world.push_back(eye.eye_world());
    session.set_eyes(std::move(eyes_world));
}

}  // namespace

Expected<void> WorldPicture::open(const ViewerConfig& config,
                                  const SurfaceOptions& options,
                                  std::unique_ptr<Surface> of) {
    surface = std::move(of);
    if (!surface) {
        auto opened = open_surface(options);
        if (!opened) return tl::unexpected(opened.error());
        surface = std::move(*opened);
    }
    const auto [width, height] = display.picture_size(surface->size());
    auto created = renderer::SceneRenderer::create(
        {.width = width,
         .height = height,
         .antialias = config.view.antialias == "fxaa" ? renderer::Antialias::kFxaa
                                                      : renderer::Antialias::kNone,
         .has_soft_outlines = config.view.outlines == "soft"});
    if (!created) return tl::unexpected(created.error());
    renderer.emplace(std::move(*created));
    annotations.emplace(config.view, surface->is_window());
    const double aspect = display.pixel_aspect(surface->size());
    if (constexpr double kSeen = 0.02; std::abs(aspect - 1.0) > kSeen) {
        app::log::warn(
            "tile_shape tile={} pixels on it are {:.2f} times as wide as high; check the "
            "projector's resolution",
            config.display.tile,
            aspect);
    }
    surface->set_title(config.bus.world + " - " + config.view.name + " - " + kWindowTitle);
    app::log::info("surface_open on=\"{}\" size={}x{}", surface->description(), width, height);
    return {};
}

std::unique_ptr<Surface> WorldPicture::close() {
    renderer.reset();
    people.clear();
    scene.clear();
    if (surface) surface->set_title(kWindowTitle);
    return std::move(surface);
}

void WorldPicture::update(Session& session, Clock::time_point now, DrawingTimes& times) {
    const std::optional<Timestamp> instant = display.instant(Timestamp::now());
    scene.update(session.take_scene(), now, instant, *renderer);
    const Clock::time_point people_begin = Clock::now();
    people.update(session, instant, now, *renderer);
    if (const std::size_t num_new = people.just_shown().size(); num_new > 0)
        times.add_people((Clock::now() - people_begin) / num_new);
}

bool WorldPicture::wait_for_files(const std::stop_token& stop,
                                  std::optional<Clock::time_point> shown_at) {
    constexpr auto kLongest = std::chrono::seconds(20);
    constexpr auto kPeriod = std::chrono::milliseconds(10);
    const Clock::time_point until = Clock::now() + kLongest;
    while (!scene.is_complete() && !stop.stop_requested()) {
        if (Clock::now() > until) {
            app::log::warn("models_not_read; the picture is written without some of them");
            return false;
        }
        std::this_thread::sleep_for(kPeriod);
        if (shown_at)
            scene.update({}, *shown_at, std::nullopt, *renderer);
        else
            scene.update({}, Clock::now(), display.instant(Timestamp::now()), *renderer);
    }
    return true;
}

void WorldPicture::draw(Session& session,
                        const renderer::ViewCamera& camera,
                        const std::string& inside,
                        Clock::time_point now,
                        DrawingTimes& times) {
    eyes = eyes_of(camera);
    set_decoder_eyes(session, eyes, renderer->overlay().silhouettes_m() > 0.0);
    annotations->take(session.proxies(), now);
    annotations->update(scene, people, inside, eyes, now, *renderer);
    times.add_preparation(Clock::now() - now);
    renderer->draw(eyes);
}

Expected<void> WorldPicture::resize() {
    const auto [width, height] = display.picture_size(surface->size());
    // a minimised window has no size
    if (width > 0 && height > 0) return renderer->resize(width, height);
    return {};
}

}  // namespace atrium::viewer
