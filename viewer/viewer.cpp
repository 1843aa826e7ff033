#include "viewer/viewer.hpp"

#include "core/app/log.hpp"
#include "core/app/process.hpp"
#include "core/app/program.hpp"
#include "core/base/processor_use.hpp"
#include "core/base/statistics.hpp"
#include "core/presence/join_world.hpp"
#include "core/status/bottleneck.hpp"
#include "viewer/control/mouse_grab.hpp"
#include "viewer/control/scene_editor.hpp"
#include "viewer/empty_world_warning.hpp"
#include "viewer/overlay/annotations.hpp"
#include "viewer/pacing/adaptive_quality.hpp"
#include "viewer/pacing/drawing_times.hpp"
#include "viewer/pacing/picture_pacer.hpp"
#include "viewer/receive/session.hpp"
#include "viewer/record/output_files.hpp"
#include "viewer/run_limit.hpp"
#include "viewer/scene/people_view.hpp"
#include "viewer/scene/scene_view.hpp"
#include "viewer/ui/display.hpp"
#include "viewer/ui/status_lines.hpp"
#include "viewer/ui/surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

namespace atrium::viewer {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kStatusPeriod = std::chrono::seconds(1);
constexpr auto kNoticePeriod = std::chrono::seconds(4);
constexpr double kHeadlessFps = 30.0;

Clock::duration seconds(double s) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
}

// Whether the display decides when a picture is shown.
bool is_paced_by_display(const ViewConfig& view, const Surface& surface) {
    return view.max_fps == 0.0 && surface.display_hz() > 0.0;
}

PictureQuality best_quality(const ViewConfig& view, const Surface& surface) {
    const double max_fps = view.max_fps > 0.0                   ? view.max_fps
                           : is_paced_by_display(view, surface) ? surface.display_hz()
                                                                : kHeadlessFps;
    return {.max_fps = max_fps, .scale = view.scale, .has_shadows = view.shadows == "on"};
}

}  // namespace

struct Viewer::Impl {
    ViewerConfig config;
    SurfaceOptions surface_options;
    renderer::ViewCamera start_camera;
    renderer::ViewCamera camera;
    Display display;
    std::unique_ptr<Session> session;

    // drawing thread only
    std::unique_ptr<Surface> surface;
    std::optional<renderer::SceneRenderer> renderer;  // destroyed before its context, `surface`
    std::optional<OutputFiles> output_files;
    std::optional<SceneView> scene;
    PeopleView people;
    std::optional<Annotations> annotations;
    std::optional<MouseGrab> mouse;
    std::optional<SceneEditor> editor;
    StatusLines reports;
    atrium::status::OverloadLog overload{bus::ProgramKind::kViewer};
    std::uint64_t listed_revision = 0;  // scene revision of hud.objects
    FollowCamera follow_camera;
    LatencyWindow latency;
    DrawingTimes times;
    std::vector<renderer::EyeView> eyes;  // eyes of the last picture
    std::optional<PicturePacer> pacer;
    std::optional<AdaptiveQuality> adaptive_quality;
    RateMeter rate;
    RateMeter byte_rate;
    History latencies_ms;  // one value per new person
    History pictures;
    HudContent hud;
    app::log::OncePerSecond command_failures;
    Clock::time_point notice_until;
    std::uint64_t num_frames = 0;
    double first_output_s = 0.0;  // 0: no picture yet
    ProcessorMeter processor_meter;
    std::optional<RunLimit> limit;
    std::optional<EmptyWorldWarning> empty_world;

    mutable std::mutex status_mutex;
    bus::ViewerStatus status;

    std::mutex lost_mutex;  // guards `lost`
    std::optional<Error> lost;
    // destroyed first: its thread uses the other members
    std::unique_ptr<presence::Membership> membership;

    std::optional<Error> lost_name() {
        const std::lock_guard lock(lost_mutex);
        return lost;
    }
    Expected<void> join(std::stop_token stop);
    Expected<void> open();
    Expected<void> show_quality();
    Expected<void> adapt_quality(Clock::duration busy, Clock::time_point now);
    Expected<void> draw_at_best();
    void note_arrivals();
    bool wait_for_picture(const std::stop_token& stop);
    Expected<void> close();
    Expected<void> loop(std::stop_token stop);
    void send(const bus::SceneCommand& command);
    void move_about(const SurfaceEvents& events);
    Expected<void> react(const SurfaceEvents& events);
    void edit(const SurfaceEvents& events);
    void list_objects();
    Expected<void> draw(Clock::time_point begin);
    void set_decoder_eyes();
    void notify_user(const std::string& notice);  // shows it on screen and logs it
    void update_status(Clock::time_point now);
};

Expected<void> Viewer::Impl::join(std::stop_token stop) {
    auto member = presence::join_world(
        session->participant(),
        bus::ProgramKind::kViewer,
        config.view.name,
        [this](const Error& error) {
            const std::lock_guard lock(lost_mutex);
            lost = error;
        },
        stop);
    if (!member) return tl::unexpected(member.error());
    membership = std::move(*member);
    return {};
}

Expected<void> Viewer::Impl::open() {
    auto opened = open_surface(surface_options);
    if (!opened) return tl::unexpected(opened.error());
    surface = std::move(*opened);
    const auto [width, height] = display.picture_size(surface->size());
    auto created = renderer::SceneRenderer::create({.width = width,
                                                    .height = height,
                                                    .antialias = config.view.antialias == "fxaa"
                                                                     ? renderer::Antialias::kFxaa
                                                                     : renderer::Antialias::kNone});
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
    app::log::info("surface_open on=\"{}\" size={}x{}", surface->description(), width, height);
    adaptive_quality.emplace(best_quality(config.view, *surface));
    const bool keeps_own_time = display.is_tile() || is_paced_by_display(config.view, *surface);
    pacer.emplace(Clock::duration(0), !keeps_own_time);
    if (auto shown = show_quality(); !shown) return shown;
    renderer->warm_up(camera);
    return {};
}

// Applies the quality to renderer, pacing and decoding.
Expected<void> Viewer::Impl::show_quality() {
    const PictureQuality& quality = adaptive_quality->quality();
    const bool is_best = adaptive_quality->level() == 0;
    // stay below the rate of a display without vertical synchronisation; one with it sets the pace
    // itself
    constexpr double kSlack = 1.05;
    const bool is_paced = is_best && is_paced_by_display(config.view, *surface);
    const Clock::duration period = seconds(1.0 / ((is_paced ? kSlack : 1.0) * quality.max_fps));
    pacer->set_period(period);
    // a wall plays back with a delay and needs every pair
    session->set_picture_period(is_best || display.is_tile() ? Clock::duration(0) : period);
    hud.quality = is_best ? "" : to_string(quality);
    renderer->set_shadows(quality.has_shadows);
    return renderer->set_scale(quality.scale);
}

Expected<void> Viewer::Impl::adapt_quality(Clock::duration busy, Clock::time_point now) {
    if (config.view.adapt == "off") return {};
    AdaptiveQuality::Picture picture{.ended = now, .busy = busy};
    for (const PeopleView::JustShown& shown : people.just_shown())
        picture.late_people = std::max(picture.late_people, shown.ready - shown.complete);
    const std::size_t before = adaptive_quality->level();
    if (!adaptive_quality->add(picture)) return {};
    const std::string line = fmt::format("{} reason={} picture_ms={:.1f}",
                                         to_string(adaptive_quality->quality()),
                                         adaptive_quality->reason(),
                                         milliseconds(busy));
    if (adaptive_quality->level() > before)
        app::log::warn("quality_reduced {}", line);
    else
        app::log::info("quality_raised {}", line);
    return show_quality();
}

// Draws the last picture again at the best quality.
Expected<void> Viewer::Impl::draw_at_best() {
    if (adaptive_quality->level() == 0 || eyes.empty()) return {};
    const PictureQuality best = best_quality(config.view, *surface);
    renderer->set_shadows(best.has_shadows);
    if (auto scaled = renderer->set_scale(best.scale); !scaled) return scaled;
    renderer->draw(eyes);
    return {};
}

void Viewer::Impl::note_arrivals() {
    for (const DecodedPeople::Arrival& arrival : session->take_arrivals())
        pacer->ready(arrival.site, arrival.at);
}

// Returns false once a stop is requested.
bool Viewer::Impl::wait_for_picture(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        note_arrivals();
        const Clock::time_point due = pacer->due();
        if (Clock::now() >= due) return true;
        session->wait_for_people(stop, due);
    }
    return false;
}

void Viewer::Impl::notify_user(const std::string& notice) {
    app::log::info("{}", notice);
    hud.notice = notice;
    notice_until = Clock::now() + kNoticePeriod;
}

Expected<void> Viewer::Impl::close() {
    auto closed = output_files->close();
    renderer.reset();
    surface.reset();
    people.clear();
    scene->clear();
    return closed;
}

void Viewer::Impl::send(const bus::SceneCommand& command) {
    if (const auto sent = session->send(command); !sent)
        command_failures.warn("command_failed " + sent.error().message);
}

void Viewer::Impl::move_about(const SurfaceEvents& events) {
    const auto pick = [this](const Ray& ray) { return scene->pick(ray); };
    const Pointer pointer = display.over_one_eye(events.pointer);
    for (const bus::SceneCommand& command : mouse->update(pointer, camera, pick, Clock::now()))
        send(command);
    Motion motion = events.motion;
    if (mouse->is_holding()) motion.turn_px.setZero();  // the drag moves the object
    const FollowCamera::Places places = people.places(*renderer);
    if (events.follow) follow_camera.toggle_follow(camera, places);
    if (events.person > 0) follow_camera.toggle_first_person(events.person, places);
    if (events.reset_view) follow_camera.leave();
    if (follow_camera.is_first_person()) {
        motion.look_around = true;
        motion.walk = false;
        motion.fly.setZero();
        motion.pan_px.setZero();
        motion.zoom_steps = 0.0;
    }
    camera = events.reset_view ? start_camera : apply(motion, camera);
    camera = follow_camera.update(camera, places, Clock::now());
}

void Viewer::Impl::edit(const SurfaceEvents& events) {
    const Clock::time_point now = Clock::now();
    const auto& objects = scene->objects();
    if (events.reset_scene) send(editor->reset());
    if (events.add) {
        const auto seen = display.eyes(camera, renderer->width(), renderer->height());
        send(editor->add(make_object(*events.add, seen.front()), objects, now));
    }
    if (events.remove) send(editor->remove(*events.remove, objects, now));
    if (events.remove_pointed && !display.is_tile()) {
        const Pointer pointer = display.over_one_eye(events.pointer);
        if (const auto hit = scene->pick(ray_through(camera, pointer)))
            send(editor->remove(hit->object, objects, now));
    }
    const SceneEditor::Servers servers{reports.has_world(), reports.num_refused()};
    for (const auto& outcome : editor->outcomes(objects, servers, now)) notify_user(outcome.text);
}

void Viewer::Impl::list_objects() {
    if (std::exchange(listed_revision, scene->revision()) == scene->revision()) return;
    hud.objects.clear();
    for (const auto& [id, object] : scene->objects())
        hud.objects.push_back({id, fmt::format("{} ({})", object.name, id)});
}

Expected<void> Viewer::Impl::react(const SurfaceEvents& events) {
    if (!display.is_tile()) move_about(events);
    if (events.screenshot) {
        if (auto drawn = draw_at_best(); !drawn) return drawn;
        notify_user(output_files->screenshot(*renderer));
        if (auto shown = show_quality(); !shown) return shown;
    }
    if (events.debug) annotations->toggle_debug();
    if (events.names) annotations->toggle_names();
    if (events.record) notify_user(output_files->toggle_video(*renderer));
    edit(events);
    // a minimised window has no size
    const auto [width, height] = display.picture_size(surface->size());
    if (width > 0 && height > 0) return renderer->resize(width, height);
    return {};
}

// The silhouettes of the debug view need the pictures of all cameras.
void Viewer::Impl::set_decoder_eyes() {
    std::vector<Eigen::Vector3d> eyes_world;
    if (!(renderer->overlay().silhouettes_m() > 0.0))
        for (const renderer::EyeView& eye : eyes) eyes_world.push_back(eye.eye_world());
    session->set_eyes(std::move(eyes_world));
}

Expected<void> Viewer::Impl::draw(Clock::time_point begin) {
    const std::optional<Timestamp> instant = display.instant(Timestamp::now());
    const Clock::time_point now = Clock::now();
    scene->update(session->take_scene(), now, instant, *renderer);
    const Clock::duration scene_took = Clock::now() - now;
    people.update(*session, instant, now, *renderer);
    note_arrivals();
    pacer->began(begin);
    if (const std::size_t num_new = people.just_shown().size(); num_new > 0)
        times.add_people((Clock::now() - now - scene_took) / num_new);
    eyes = display.eyes(camera, renderer->width(), renderer->height());
    set_decoder_eyes();
    const std::string inside = follow_camera.is_first_person() ? follow_camera.name() : "";
    annotations->take(session->proxies(), now);
    annotations->update(*scene, people, inside, eyes, now, *renderer);
    times.add_preparation(Clock::now() - now);
    renderer->draw(eyes);
    list_objects();
    hud.num_objects = renderer->num_objects();
    hud.recording_s = output_files->video_s();
    hud.num_video_dropped = output_files->num_dropped();
    if (now > notice_until) hud.notice.clear();
    surface->show(*renderer, hud);
    const Timestamp displayed = Timestamp::now();
    const Clock::time_point shown_at = Clock::now();
    pictures.add(1.0, now);
    for (const PeopleView::JustShown& shown : people.just_shown()) {
        latency.add(displayed - shown.captured);
        latencies_ms.add(milliseconds(displayed - shown.captured), now);
        times.add_way(shown.ready - shown.complete, now - shown.ready, shown_at - shown.complete);
    }
    if (num_frames == 0) first_output_s = app::seconds_since_start();
    ++num_frames;
    output_files->add(*renderer, limit->is_counting());
    return {};
}

void Viewer::Impl::update_status(Clock::time_point now) {
    const Quantiles quantiles = latency.quantiles();
    hud.capture_to_display = {quantiles.median_ms, quantiles.p99_ms, quantiles.num_samples};
    hud.frames_per_s = rate.update(num_frames, now);
    hud.sites = people.lines(now);
    hud.bytes_per_s = byte_rate.update(session->num_bytes(), now);
    hud.num_skipped = session->num_pairs_skipped();
    hud.num_incomplete = session->num_incomplete();
    hud.num_rejected = session->num_rejected();
    hud.latency_ms = latencies_ms.values(History::Of::kMean, now);
    hud.pictures_per_s = pictures.values(History::Of::kPerSecond, now);
    bus::ViewerStatus next;
    next.viewer = config.view.name;
    next.time = Timestamp::now();
    next.num_frames = num_frames;
    next.num_pairs_shown = people.num_pairs_shown();
    next.num_pairs_skipped = session->num_pairs_skipped();
    next.num_incomplete = session->num_incomplete();
    next.num_rejected = session->num_rejected();
    next.frames_per_s = hud.frames_per_s;
    next.capture_to_display = hud.capture_to_display;
    next.resident_bytes = app::resident_bytes();
    next.processor = processor_meter.update(now);
    next.first_output_s = first_output_s;
    next.max_frames_per_s = adaptive_quality->quality().max_fps;
    next.scale = adaptive_quality->quality().scale;
    next.has_shadows = adaptive_quality->quality().has_shadows;
    next.num_video_dropped = output_files->num_dropped();
    const StatusReports came = session->take_statuses();
    for (const auto& [site, report] : came.sites) reports.add(site, report, now);
    for (const auto& [world, report] : came.worlds) reports.add(world, report, now);
    reports.add_own(next, now);
    reports.forget_silent(now);
    hud.warnings = reports.warnings();
    hud.details = reports.details();
    if (const auto line = overload.look(atrium::status::figures_of(next), now))
        app::log::warn("{}", *line);
    const std::lock_guard lock(status_mutex);
    status = next;
}

Expected<void> Viewer::Impl::loop(std::stop_token stop) {
    const Clock::time_point begin = Clock::now();
    limit.emplace(config, begin);
    Clock::time_point status_due = begin;
    while (wait_for_picture(stop)) {
        const Clock::time_point picture_begin = Clock::now();
        const SurfaceEvents events = surface->poll();
        if (events.close) break;
        if (const auto error = lost_name()) return tl::unexpected(*error);
        if (auto done = react(events); !done) return done;
        if (auto done = draw(picture_begin); !done) return done;
        const Clock::time_point now = Clock::now();
        if (now >= status_due) {
            status_due = now + kStatusPeriod;
            update_status(now);
            empty_world->update(membership->present(), now, false);
            if (auto sent = session->publish(status); !sent)
                app::log::warn("status_failed {}", sent.error().message);
        }
        const auto run = limit->update(num_frames, people.size(), now);
        if (!run) return tl::unexpected(run.error());
        if (*run == RunLimit::Now::kOver) break;
        if (*run == RunLimit::Now::kBegan) {
            times.begin_pictures();
            // this picture shows the people; the next may take long
            output_files->add(*renderer, true);
        }
        const Clock::time_point end = Clock::now();
        times.add_picture(end - picture_begin);
        const Clock::duration busy = end - picture_begin - surface->waited_for_display();
        if (auto done = adapt_quality(busy, end); !done) return done;
    }
    return {};
}

Viewer::Viewer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Viewer::~Viewer() = default;

Expected<std::unique_ptr<Viewer>> Viewer::create(const ViewerConfig& config,
                                                 std::stop_token stop,
                                                 SurfaceIs surface_is) {
    if (auto named = check_file_names(config); !named) return tl::unexpected(named.error());
    const auto camera = make_view_camera(config.view);
    if (!camera) return tl::unexpected(camera.error());
    const auto surface = surface_options(config);
    if (!surface) return tl::unexpected(surface.error());
    auto display = Display::create(config.display);
    if (!display) return tl::unexpected(display.error());
    auto impl = std::make_unique<Impl>();
    impl->config = config;
    if (config.view.name.empty()) impl->config.view.name = make_unique_name();
    auto session = Session::create(config.bus, impl->config.view.name);
    if (!session) return tl::unexpected(session.error());
    impl->surface_options = *surface;
    impl->start_camera = impl->camera = *camera;
    impl->display = std::move(*display);
    impl->session = std::move(*session);
    impl->scene.emplace(config.models, impl->display.delay());
    impl->output_files.emplace(impl->config);
    impl->empty_world.emplace(config.bus.world);
    impl->mouse.emplace(impl->config.view.name);
    impl->editor.emplace(impl->config.view.name);
    Expected<void> joined;
    Expected<void> opened;
    {
        // claiming a name takes most of a second
        const std::jthread joining([&] { joined = impl->join(stop); });
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
    Expected<void> opened;
    if (!impl_->surface) opened = impl_->open();
    if (opened) opened = impl_->output_files->open(*impl_->renderer);
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
            result = impl_->loop(stop);
        }
        session.stop_decoding();
    }
    impl_->update_status(Clock::now());
    impl_->empty_world->update(impl_->membership->present(), Clock::now(), true);
    const bus::ViewerStatus last = status();
    app::log::info(
        "viewer_stopped frames={} frames_per_s={:.1f} pairs_shown={} pairs_skipped={} "
        "incomplete={} rejected={} capture_to_display_ms={:.1f} p99_ms={:.1f} "
        "{} deadlines_missed={} {}",
        last.num_frames,
        impl_->limit ? impl_->limit->frames_per_s() : 0.0,
        last.num_pairs_shown,
        last.num_pairs_skipped,
        last.num_incomplete,
        last.num_rejected,
        last.capture_to_display.median_ms,
        last.capture_to_display.p99_ms,
        impl_->times.text(),
        impl_->session->num_deadlines_missed(),
        atrium::status::process_fields(last.processor, last.first_output_s));
    // also after an error: the picture shows who was there
    auto written = impl_->draw_at_best();
    if (written) written = impl_->output_files->write_output(*impl_->renderer);
    const auto closed = impl_->close();
    return !result ? result : !written ? written : closed;
}

bus::ViewerStatus Viewer::status() const {
    const std::lock_guard lock(impl_->status_mutex);
    return impl_->status;
}

}  // namespace atrium::viewer
