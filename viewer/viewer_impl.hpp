#pragma once

#include "viewer/control/site_selection.hpp"
#include "viewer/control/start_view.hpp"
#include "viewer/control/user_control.hpp"
#include "viewer/control/viewpoint_control.hpp"
#include "viewer/pacing/drawing_control.hpp"
#include "viewer/playback/playback.hpp"
#include "viewer/receive/session.hpp"
#include "viewer/receive/world_membership.hpp"
#include "viewer/record/output_files.hpp"
#include "viewer/run_limit.hpp"
#include "viewer/scene/model_folder.hpp"
#include "viewer/ui/display.hpp"
#include "viewer/ui/site_lines.hpp"
#include "viewer/ui/surface.hpp"
#include "viewer/ui/viewer_statistics.hpp"
#include "viewer/ui/world_picture.hpp"
#include "viewer/viewer.hpp"

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>

/// The parts of a viewer: viewer.cpp makes and ends them, viewer_loop.cpp has the pictures.
namespace atrium::viewer {

// Connects the parts. All but `session` and `membership` belong to the drawing thread.
struct Viewer::Impl {
    using Clock = std::chrono::steady_clock;

    Impl(ViewerConfig configuration,
         const SurfaceOptions& surface,
         const renderer::ViewCamera& camera,
         Display display,
         std::unique_ptr<Session> of)
        : config(std::move(configuration)),
          surface_options(surface),
          session(std::move(of)),
          picture(config, std::move(display)),
          start_view(camera, config.wait_people, !has_view(config.view)),
          control(camera, config.view.name, picture.display.is_tile()),
          models(config.models),
          viewpoints(ViewpointBook(config.viewpoints, config.viewpoint_file, config.bus.world)),
          output_files(config),
          statistics(config.view.name) {
        hud.world = config.bus.world;
        hud.has_other_worlds = config.has_other_worlds;
        list_viewpoints();
    }

    ViewerConfig config;
    SurfaceOptions surface_options;
    std::unique_ptr<Playback> playback;  // null: a living world
    recording::LeftOut left_out;         // of the recording
    app::log::OncePerSecond left_out_log;
    std::unique_ptr<Session> session;
    WorldPicture picture;
    std::optional<DrawingControl> drawing;  // from `open` to `close`
    StartView start_view;
    UserControl control;
    Pointer pointer;  // in the picture of one eye
    ModelFolder models;
    ViewpointControl viewpoints;
    SiteSelection sites;
    std::unique_ptr<Surface> given_surface;   // until `open`
    std::unique_ptr<Surface> closed_surface;  // from `close` on, if the user wants another world
    bool wants_other_world = false;
    OutputFiles output_files;
    ViewerStatistics statistics;
    std::optional<RunLimit> limit;
    HudContent hud;
    DepartedPeople departed;
    std::uint64_t listed_revision = 0;  // scene revision of hud.objects
    Clock::time_point notice_until;
    app::log::OncePerSecond command_failures;
    WorldMembership membership;

    Expected<void> open();
    Expected<void> close();
    Expected<void> loop(std::stop_token stop);
    Expected<void> react(const SurfaceEvents& events);
    void send(const UserControl::Commands& commands);
    void notify_user(const std::string& notice);  // shows it on screen and logs it
    void show_notice(const std::string& notice);
    void draw(Clock::time_point begin);
    UserControl::Shown shown() const;
    void take_edit_news(Clock::time_point now);
    void send_edits();
    void select(const SurfaceEvents& events, Clock::time_point now);
    void list_viewpoints();
    void fill_hud(Clock::time_point now);
    Expected<void> adapt_quality(Clock::duration busy, Clock::time_point ended);
    void update_status(Clock::time_point now);
};

}  // namespace atrium::viewer
