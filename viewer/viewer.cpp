#include "viewer/viewer.hpp"

#include "core/app/log.hpp"
#include "core/base/statistics.hpp"
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

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <thread>
#include <utility>

namespace atrium::viewer {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kStatusPeriod = std::chrono::seconds(1);
constexpr auto kNoticePeriod = std::chrono::seconds(4);

}  // namespace

// Connects the parts. All but `session` and `membership` belong to the drawing thread.
struct Viewer::Impl {
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

Expected<void> Viewer::Impl::open() {
    if (auto opened = picture.open(config, surface_options, std::move(given_surface)); !opened)
        return opened;
    drawing.emplace(config.view,
                    picture.surface->display_hz(),
                    picture.display.is_tile(),
                    *session,
                    *picture.renderer);
    if (auto applied = drawing->apply(); !applied) return applied;
    picture.renderer->warm_up(control.camera());
    return {};
}

Expected<void> Viewer::Impl::close() {
    auto closed = output_files.close();
    drawing.reset();
    auto surface = picture.close();
    if (wants_other_world) closed_surface = std::move(surface);
    return closed;
}

void Viewer::Impl::notify_user(const std::string& notice) {
    app::log::info("{}", notice);
    show_notice(notice);
}

void Viewer::Impl::show_notice(const std::string& notice) {
    hud.notice = notice;
    notice_until = Clock::now() + kNoticePeriod;
}

void Viewer::Impl::send(const UserControl::Commands& commands) {
    for (const bus::SceneCommand& command : commands) {
        if (const auto sent = session->send(command); !sent)
            command_failures.warn("command_failed " + sent.error().message);
    }
}

UserControl::Shown Viewer::Impl::shown() const {
    using Pickable = SceneView::Pickable;
    renderer::EyeView eye = picture.eyes_of(control.camera()).front();
    eye.part_px = {0, 0, pointer.width_px, pointer.height_px};  // in the units of the pointer
    const FollowCamera::Places people = picture.people.places(*picture.renderer);
    return {pointer,
            [this](const Ray& ray) { return picture.scene.pick(ray); },
            people,
            picture.scene.objects(),
            [this](const Ray& ray) { return picture.scene.pick(ray, Pickable::kAllButPlanes); },
            picture.scene.states(),
            eye,
            picture.people.not_hidden(people)};
}

void Viewer::Impl::take_edit_news(Clock::time_point now) {
    for (const std::string& text : control.take(session->edits().take(), now)) notify_user(text);
}

void Viewer::Impl::send_edits() {
    for (const bus::SceneEdit& edit : control.take_edits()) {
        if (const auto sent = session->edits().send(edit); !sent) {
            command_failures.warn("edit_failed " + sent.error().message);
            show_notice("not sent: " + sent.error().message);
        }
    }
}

Expected<void> Viewer::Impl::react(const SurfaceEvents& events) {
    renderer::SceneRenderer& renderer = *picture.renderer;
    const Clock::time_point now = Clock::now();
    pointer = picture.display.over_one_eye(events.pointer);
    take_edit_news(now);
    const UserControl::Shown shown = this->shown();
    send(control.move(events, shown, now));
    select(events, now);
    models.show(events.show_models);
    models.measure(events.measure_model);
    hud.measured_model = events.measure_model;
    if (events.screenshot) {
        if (auto drawn = drawing->draw_at_best(picture.eyes); !drawn) return drawn;
        notify_user(output_files.screenshot(renderer));
        if (auto applied = drawing->apply(); !applied) return applied;
    }
    if (events.reset_scene)
        show_notice(statistics.servers().are_there ? "asking the world server to reset all objects"
                                                   : "not reset: no world server is running");
    if (!events.edit.hint.empty()) show_notice(events.edit.hint);
    if (events.debug) picture.annotations->toggle_debug();
    if (events.names) picture.annotations->toggle_names();
    if (events.stream) notify_user(output_files.toggle_stream(renderer));
    if (events.record) notify_user(output_files.toggle_video(renderer));
    for (const PlaybackEvent& event : events.playback) {
        const std::string said = playback ? playback->apply(event, control.camera())
                                          : "this key is for recordings: viewer FILE.mcap";
        if (!said.empty()) show_notice(said);
    }
    send(control.edit(events, shown, picture.eyes_of(control.camera()).front(), now));
    send_edits();
    for (const auto& outcome : control.outcomes(shown.objects, statistics.servers(), now))
        notify_user(outcome.text);
    return picture.resize();
}

// What the user wants to see, and from where.
void Viewer::Impl::select(const SurfaceEvents& events, Clock::time_point now) {
    if (!events.hide_site.empty()) sites.toggle(events.hide_site);
    if (!events.solo_site.empty()) sites.toggle_solo(events.solo_site);
    if (!events.viewpoint) return;
    notify_user(viewpoints.handle(*events.viewpoint, control, now));
    list_viewpoints();
}

void Viewer::Impl::list_viewpoints() {
    hud.viewpoints.clear();
    const ViewpointBook& book = viewpoints.book();
    for (int number = 1; number <= ViewpointBook::kNum; ++number) {
        if (const auto& viewpoint = book.at(number))
            hud.viewpoints.push_back({number, viewpoint->name, book.is_own(number)});
    }
}

void Viewer::Impl::fill_hud(Clock::time_point now) {
    statistics.watch_world(now, *session, hud);
    mark_selected(sites, hud.sites);
    hud.inside = control.inside();
    hud.followed = control.followed();
    if (std::exchange(listed_revision, picture.scene.revision()) != picture.scene.revision()) {
        hud.objects.clear();
        for (const auto& [id, object] : picture.scene.objects())
            hud.objects.push_back({id, fmt::format("{} ({})", object.name, id)});
    }
    models.update();
    hud.models = models.list();
    hud.models_folder = config.models.string();
    const ModelSize* measured = models.size_of(hud.measured_model);
    hud.model_size = measured == nullptr ? std::nullopt : std::optional(*measured);
    hud.num_objects = picture.renderer->num_objects();
    hud.recording_s = output_files.video_s();
    hud.video_fps = config.video.fps;
    hud.live = output_files.live();
    hud.quality = drawing->reduced_quality();
    if (now > notice_until) hud.notice.clear();
}

void Viewer::Impl::draw(Clock::time_point begin) {
    const Clock::time_point now = Clock::now();
    picture.people.show_only(sites, control.inside());
    if (playback) {
        hud.timeline = {playback->state(), &playback->thumbnails()};
        picture.people.hold(!hud.timeline->state.is_playing);
    }
    picture.update(*session, now, statistics.times());
    const FollowCamera::Places people = picture.people.places(*picture.renderer);
    if (const auto view = start_view.update(people, picture.aspect(), picture.sight(), now))
        control.set_start(*view);
    drawing->began(begin);
    hud.edit = control.edit_view(shown());
    picture.annotations->set_edit(hud.edit);
    picture.draw(*session, control.camera(), control.inside(), now, statistics.times());
    hud.names = picture.annotations->boxes();
    fill_hud(now);
    picture.surface->show(*picture.renderer, hud);
    statistics.add_picture(picture.people.just_shown(), now);
    output_files.add(*picture.renderer, limit->is_counting());
}

Expected<void> Viewer::Impl::adapt_quality(Clock::duration busy, Clock::time_point ended) {
    AdaptiveQuality::Picture cost{.ended = ended, .busy = busy};
    for (const PeopleView::JustShown& shown : picture.people.just_shown())
        cost.late_people = std::max(cost.late_people, shown.ready - shown.complete);
    return drawing->adapt(cost);
}

void Viewer::Impl::update_status(Clock::time_point now) {
    hud.num_video_dropped = output_files.num_dropped();
    hud.bad_files = picture.scene.bad_files();
    hud.other_worlds = membership.other_worlds();
    hud.preparing = membership.sites_other_than(picture.scene.site_names());
    statistics.update(
        now, *session, picture.people, picture.scene.site_names(), drawing->quality(), hud);
    hud.left = departed.update(hud.sites, now);
}

Expected<void> Viewer::Impl::loop(std::stop_token stop) {
    const Clock::time_point begin = Clock::now();
    limit.emplace(config, begin);
    Clock::time_point status_due = begin;
    while (drawing->wait(stop)) {
        const Clock::time_point picture_begin = Clock::now();
        const SurfaceEvents events = picture.surface->poll();
        wants_other_world = events.other_world && config.has_other_worlds;
        if (events.other_world && !wants_other_world)
            notify_user("this run shows one world: it has an end, or writes a picture or video");
        if (events.close || wants_other_world) break;
        if (auto named = membership.check_name(); !named) return named;
        if (auto done = react(events); !done) return done;
        draw(picture_begin);
        const Clock::time_point now = Clock::now();
        if (now >= status_due) {
            status_due = now + kStatusPeriod;
            update_status(now);
            membership.warn_if_alone(now, false);
            if (auto sent = session->publish(statistics.status()); !sent)
                app::log::warn("status_failed {}", sent.error().message);
        }
        const auto run = limit->update(statistics.num_pictures(), picture.people.size(), now);
        if (!run) {
            return make_error(
                run.error().kind,
                run.error().message +
                    RunLimit::cure(membership.place(),
                                   membership.sites_other_than(picture.scene.site_names())));
        }
        if (*run == RunLimit::Now::kOver) break;
        if (*run == RunLimit::Now::kBegan) {
            statistics.times().begin_pictures();
            // this picture shows the people; the next may take long
            output_files.add(*picture.renderer, true);
        }
        const Clock::time_point end = Clock::now();
        statistics.times().add_picture(end - picture_begin);
        const Clock::duration busy = end - picture_begin - picture.surface->waited_for_display();
        if (auto done = adapt_quality(busy, end); !done) return done;
    }
    return {};
}

Viewer::Viewer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Viewer::~Viewer() = default;

Expected<std::unique_ptr<Viewer>> Viewer::create(const ViewerConfig& config,
                                                 std::stop_token stop,
                                                 SurfaceIs surface_is,
                                                 std::unique_ptr<Surface> given) {
    if (auto named = check_names(config); !named) return tl::unexpected(named.error());
    const auto camera = make_view_camera(config.view);
    if (!camera) return tl::unexpected(camera.error());
    const auto surface = surface_options(config);
    if (!surface) return tl::unexpected(surface.error());
    auto display = Display::create(config.display);
    if (!display) return tl::unexpected(display.error());
    ViewerConfig named_config = config;
    if (config.view.name.empty()) named_config.view.name = make_unique_name();
    std::unique_ptr<Playback> playback;
    if (const RecordingConfig& recording = config.recording; !recording.file.empty()) {
        auto found = Playback::open(recording.file, recording.path, named_config.bus);
        if (!found) return tl::unexpected(found.error());
        playback = std::move(*found);
    }
    auto session = Session::create(named_config.bus, named_config.view.name);
    if (!session) return tl::unexpected(session.error());
    auto impl = std::make_unique<Impl>(
        std::move(named_config), *surface, *camera, std::move(*display), std::move(*session));
    impl->playback = std::move(playback);
    impl->given_surface = std::move(given);
    Expected<void> joined;
    Expected<void> opened;
    {
        // claiming a name takes most of a second
        const std::jthread joining([&] {
            joined =
                impl->membership.join(impl->session->participant(), impl->config.view.name, stop);
        });
        if (surface_is == SurfaceIs::kOpenedNow) opened = impl->open();
    }
    for (const Expected<void>& done : {joined, opened}) {
        if (done) continue;
        static_cast<void>(impl->close());
        return tl::unexpected(done.error());
    }
    return std::unique_ptr<Viewer>(new Viewer(std::move(impl)));
}

Expected<void> Viewer::run(std::stop_token stop) {
    Expected<void> opened = impl_->picture.surface ? Expected<void>() : impl_->open();
    if (opened) opened = impl_->output_files.open(*impl_->picture.renderer);
    if (!opened) {
        static_cast<void>(impl_->close());
        return opened;
    }
    Expected<void> result;
    {
        Session& session = *impl_->session;
        session.start_decoding();
        {
            const std::jthread receiving([&](std::stop_token own) { session.receive(own); });
            if (impl_->playback)
                result = impl_->playback->start(session.participant(), impl_->config.recording);
            if (result) result = impl_->loop(stop);
            if (impl_->playback) impl_->playback->stop();
        }
        session.stop_decoding();
    }
    impl_->update_status(Clock::now());
    impl_->membership.warn_if_alone(Clock::now(), true);
    impl_->statistics.log_stopped(impl_->limit ? impl_->limit->frames_per_s() : 0.0,
                                  impl_->session->num_deadlines_missed());
    // also after an error: the picture shows who was there
    if (!impl_->config.output.empty()) impl_->picture.wait_for_files(stop);
    auto written = impl_->drawing->draw_at_best(impl_->picture.eyes);
    if (written) written = impl_->output_files.write_output(*impl_->picture.renderer);
    const auto closed = impl_->close();
    return !result ? result : !written ? written : closed;
}

std::unique_ptr<Surface> Viewer::take_surface() { return std::move(impl_->closed_surface); }

bool Viewer::has_window() const {
    return impl_->picture.surface && impl_->picture.surface->is_window();
}

bool Viewer::has_met_others() const {
    return impl_->session->world_heard() || impl_->membership.has_met_others();
}

bus::ViewerStatus Viewer::status() const { return impl_->statistics.status(); }

}  // namespace atrium::viewer
