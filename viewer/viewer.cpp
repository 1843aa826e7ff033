#include "viewer/viewer.hpp"

#include "core/app/log.hpp"
#include "viewer/viewer_impl.hpp"

#include <thread>
#include <utility>

namespace atrium::viewer {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kNoticePeriod = std::chrono::seconds(4);

}  // namespace

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
    if (!impl_->playback) impl_->membership.warn_if_alone(Clock::now(), true);
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
