#include "core/app/log.hpp"
#include "viewer/viewer_impl.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace atrium::viewer {
namespace {

constexpr auto kStatusPeriod = std::chrono::seconds(1);

}  // namespace

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
        show_notice(playback ? "not reset: this is a recording"
                    : statistics.servers().are_there
                        ? "asking the world server to reset all objects"
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
    if (!playback) statistics.watch_world(now, *session, hud);
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
        const recording::PlayState state = playback->state();
        if (const auto line = left_out.update(state)) left_out_log.warn(*line);
        hud.timeline = {state, playback->world().begin() + state.time, &playback->thumbnails()};
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
            notify_user(playback ? "this run shows a recording: other worlds are in `viewer` alone"
                                 : "this run shows one world: it has an end, or writes a picture "
                                   "or video");
        if (events.close || wants_other_world) break;
        if (auto named = membership.check_name(); !named) return named;
        if (auto done = react(events); !done) return done;
        draw(picture_begin);
        const Clock::time_point now = Clock::now();
        if (now >= status_due) {
            status_due = now + kStatusPeriod;
            update_status(now);
            if (!playback) membership.warn_if_alone(now, false);
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

}  // namespace atrium::viewer
