#include "viewer/playback/playback.hpp"

#include "core/app/log.hpp"
#include "core/base/named_thread.hpp"
#include "core/bus/limits.hpp"
#include "core/recording/view_path.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

namespace atrium::viewer {

using std::chrono::nanoseconds;

namespace {

constexpr std::chrono::seconds kMatching{5};

}  // namespace

Expected<std::unique_ptr<Playback>> Playback::open(const std::filesystem::path& file,
                                                   const std::filesystem::path& path,
                                                   bus::BusOptions& options) {
    auto world = recording::WorldFile::open(file);
    if (!world) return tl::unexpected(world.error());
    const recording::WorldFile& opened = **world;
    app::log::info("recording file={} world={} seconds={:.1f} sites={}",
                   file.string(),
                   opened.world(),
                   std::chrono::duration<double>(opened.duration()).count(),
                   fmt::join(opened.sites(), ","));
    for (const std::string& line : opened.warnings()) app::log::warn("{}", line);
    if (!options.world.empty() && options.world != opened.world())
        app::log::warn("world_ignored world={}: a recording is shown by itself", options.world);
    options.world = opened.world();
    options.network = "private";
    options.domain = bus::kMaxDomain;
    options.peers.clear();
    options.interface.clear();
    std::filesystem::path path_file = path;
    if (path_file.empty()) {
        path_file = file;
        path_file.replace_extension(".path.json");
    }
    return std::unique_ptr<Playback>(new Playback(std::move(*world), std::move(path_file)));
}

Expected<void> Playback::start(const bus::Participant& participant, const RecordingConfig& config) {
    auto player = recording::Player::create(world_, participant, {});
    if (!player) return tl::unexpected(player.error());
    player_ = std::move(*player);
    const nanoseconds from = from_milliseconds(config.from_s * 1e3);
    if (from >= world_->duration() && from.count() > 0) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("recording.from: {:g} s is behind the end: the recording has "
                                      "{:.1f} s",
                                      config.from_s,
                                      std::chrono::duration<double>(world_->duration()).count()));
    }
    player_->set_marks(
        from, config.to_s > 0.0 ? from_milliseconds(config.to_s * 1e3) : world_->duration());
    player_->set_loop(config.loop);
    player_->seek(from);
    if (!config.paused)
        player_->play();
    else
        player_->show_first();
    thumbnails_ = std::make_unique<Thumbnails>(world_);
    // The bus of this process tells writers of their readers a moment after they are made.
    playing_ = named_thread("play", [this](std::stop_token stop) {
        static_cast<void>(player_->wait_for_readers(kMatching));
        player_->run(std::move(stop));
    });
    return {};
}

void Playback::stop() {
    if (!playing_.joinable()) return;
    playing_.request_stop();
    playing_.join();
}

recording::PlayState Playback::state() const { return player_->state(); }

std::string Playback::keep_view(nanoseconds time, const renderer::ViewCamera& camera) {
    recording::ViewPath path;
    std::error_code failure;
    if (std::filesystem::exists(path_file_, failure)) {
        auto loaded = recording::ViewPath::load(path_file_);
        if (!loaded) return "not kept: " + loaded.error().message;
        path = std::move(*loaded);
    }
    path.add({time, camera.position_m, camera.target_m, camera.fov_deg});
    if (const auto saved = path.save(path_file_); !saved)
        return "not kept: " + saved.error().message;
    return fmt::format("camera path: viewpoint {} of {}, in {}",
                       path.number_at(time),
                       path.keys().size(),
                       path_file_.string());
}

std::string Playback::apply(const PlaybackEvent& event, const renderer::ViewCamera& camera) {
    using Kind = PlaybackEvent::Kind;
    const recording::PlayState now = player_->state();
    switch (event.kind) {
        case Kind::kToggle:
            now.is_playing ? player_->pause() : player_->play();
            break;
        case Kind::kStep:
            player_->step(event.number);
            break;
        case Kind::kSeek:
            player_->seek(event.time);
            break;
        case Kind::kSeekBy:
            player_->seek(now.time + event.time);
            break;
        case Kind::kSpeed:
            player_->set_speed(event.factor);
            return fmt::format("speed {:g}", player_->state().speed);
        case Kind::kSpeedBy:
            player_->set_speed(now.speed * event.factor);
            return fmt::format("speed {:g}", player_->state().speed);
        case Kind::kToggleLoop:
            player_->set_loop(!now.loops);
            break;
        case Kind::kMarkIn:
            if (now.time >= now.out) return "the in mark must be before the out mark";
            player_->set_marks(now.time, now.out);
            break;
        case Kind::kMarkOut:
            if (now.time <= now.in) return "the out mark must be behind the in mark";
            player_->set_marks(now.in, now.time);
            break;
        case Kind::kClearMarks:
            player_->set_marks(nanoseconds(0), now.duration);
            break;
        case Kind::kKeepView:
            return keep_view(now.time, camera);
    }
    return {};
}

}  // namespace atrium::viewer
