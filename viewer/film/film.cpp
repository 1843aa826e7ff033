#include "viewer/film/film.hpp"

#include "core/app/log.hpp"
#include "core/app/progress.hpp"
#include "core/recording/player.hpp"
#include "core/recording/view_path.hpp"
#include "viewer/control/start_view.hpp"
#include "viewer/playback/playback.hpp"
#include "viewer/receive/session.hpp"
#include "viewer/record/video_file.hpp"
#include "viewer/ui/display.hpp"
#include "viewer/ui/surface.hpp"
#include "viewer/ui/world_picture.hpp"

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

namespace atrium::viewer {
namespace {

using std::chrono::nanoseconds;
using Clock = std::chrono::steady_clock;

// As few samples at once as the bus keeps of each.
constexpr nanoseconds kAdvance = std::chrono::milliseconds(50);
constexpr nanoseconds kFilmMatching = std::chrono::seconds(5);
constexpr nanoseconds kLead = std::chrono::seconds(1);  // of states before the first picture

// The clock of the film, on which people and objects arrive and are shown.
Clock::time_point at(nanoseconds time) {
    return Clock::time_point(std::chrono::hours(1)) +
           std::chrono::duration_cast<Clock::duration>(time);
}

renderer::ViewCamera camera_of(const recording::ViewKey& key, renderer::ViewCamera camera) {
    camera.position_m = key.position_m;
    camera.target_m = key.target_m;
    camera.fov_deg = key.fov_deg;
    return camera;
}

class Film {
public:
    Film(const ViewerConfig& config,
         std::unique_ptr<Session> session,
         std::unique_ptr<recording::Player> player,
         Display display)
        : config_(config),
          session_(std::move(session)),
          player_(std::move(player)),
          picture_(config, std::move(display)) {}

    Expected<void> open(const SurfaceOptions& options) {
        if (auto opened = picture_.open(config_, options, nullptr); !opened) return opened;
        const auto camera = make_view_camera(config_.view);
        if (!camera) return tl::unexpected(camera.error());
        camera_ = *camera;
        if (!config_.recording.path.empty()) {
            auto path = recording::ViewPath::load(config_.recording.path);
            if (!path) return tl::unexpected(path.error());
            path_ = std::move(*path);
        }
        picture_.renderer->warm_up(camera_);
        session_->start_decoding();
        return {};
    }

    Expected<void> render(const std::stop_token& stop);

private:
    // Brings session and scene to that time of the recording. Waits for models and textures: at
    // their own pace they would come too late.
    void show(nanoseconds time, const std::stop_token& stop) {
        while (time_ < time) {
            time_ = std::min(time, time_ + kAdvance);
            player_->advance(time_);
            session_->receive_all();
        }
        SceneChanges changes = session_->take_scene();
        for (auto& [state, arrival] : changes.states) arrival = at(time);
        picture_.scene.update(std::move(changes), at(time), std::nullopt, *picture_.renderer);
        if (waits_for_files_) waits_for_files_ = picture_.wait_for_files(stop, at(time));
        picture_.people.update(*session_, std::nullopt, at(time), *picture_.renderer);
    }

    renderer::ViewCamera camera(nanoseconds time) {
        if (path_) return camera_of(path_->at(time), camera_);
        if (!has_view(config_.view)) {
            // as a living viewer: from where the first people are seen whole
            const FollowCamera::Places people = picture_.people.places(*picture_.renderer);
            const auto view =
                start_view_->update(people, picture_.aspect(), picture_.sight(), at(time));
            if (view) camera_ = *view;
        }
        return camera_;
    }

    Expected<void> write(VideoFile& video, const VideoFormat& format);

    const ViewerConfig& config_;
    std::unique_ptr<Session> session_;
    std::unique_ptr<recording::Player> player_;
    WorldPicture picture_;
    DrawingTimes times_;
    renderer::ViewCamera camera_;
    std::optional<recording::ViewPath> path_;
    std::optional<StartView> start_view_;
    nanoseconds time_{0};
    bool waits_for_files_ = true;  // until that took too long once
    renderer::RenderedPicture pixels_;
    cv::Mat small_;
};

// Reads the picture back and scales it down to the video: each pixel is the mean of those drawn.
Expected<void> Film::write(VideoFile& video, const VideoFormat& format) {
    picture_.renderer->read_pixels(pixels_);
    const cv::Mat drawn(pixels_.height, pixels_.width, CV_8UC4, pixels_.rgba.data());
    cv::resize(drawn, small_, {format.width, format.height}, 0.0, 0.0, cv::INTER_AREA);
    const std::span<const std::uint8_t> rgba(small_.data, small_.total() * small_.elemSize());
    if (auto set = video.set(rgba); !set) return set;
    return video.write();
}

Expected<void> Film::render(const std::stop_token& stop) {
    const recording::PlayState state = player_->state();
    const nanoseconds begin = from_milliseconds(config_.recording.from_s * 1e3);
    const nanoseconds end =
        config_.recording.to_s > 0.0
            ? std::min(from_milliseconds(config_.recording.to_s * 1e3), state.duration)
            : state.duration;
    if (begin >= end) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("recording.from: {:g} s is behind the end, {:.1f} s",
                                      config_.recording.from_s,
                                      std::chrono::duration<double>(end).count()));
    }
    const int supersample = config_.video.supersample;
    VideoFormat format{config_.video.file, config_.video.fps};
    std::tie(format.width, format.height) = video_size(
        config_.video,
        {picture_.renderer->width() / supersample, picture_.renderer->height() / supersample});
    auto video = create_video_file(format);
    if (!video) return tl::unexpected(video.error());
    start_view_.emplace(camera_, config_.wait_people, true);
    time_ = std::max(nanoseconds(0), begin - kLead);
    if (!player_->wait_for_readers(kFilmMatching))
        return make_error(ErrorKind::kInternal, "the recording's topics have no readers");
    player_->show_now(time_);
    session_->receive_all();
    show(begin, stop);
    const double length_s = std::chrono::duration<double>(end - begin).count();
    const auto num = static_cast<std::size_t>(std::max(1.0, std::floor(length_s * format.fps)));
    app::Progress progress("picture", num, std::chrono::seconds(2));
    std::size_t done = 0;
    for (; done < num && !stop.stop_requested(); ++done) {
        const auto time =
            begin + nanoseconds(std::llround(static_cast<double>(done) * 1e9 / format.fps));
        show(time, stop);
        picture_.draw(*session_, camera(time), "", at(time), times_);
        if (auto written = write(**video, format); !written) return written;
        if (const auto line = progress.update(done + 1)) app::log::info("film {}", *line);
    }
    if (auto finished = (*video)->finish(); !finished) return finished;
    const recording::PlayState played = player_->state();
    if (done < num)
        app::log::warn("film_cut file={} pictures={} of={}", format.file.string(), done, num);
    if (const auto line = recording::LeftOut().update(played)) app::log::warn("{}", *line);
    app::log::info(
        "film_written file={} pictures={} seconds={:.2f} size={}x{} refused={} "
        "damaged={} rejected={}",
        format.file.string(),
        done,
        static_cast<double>(done) / format.fps,
        format.width,
        format.height,
        played.num_refused,
        played.num_damaged,
        session_->num_rejected());
    session_->stop_decoding();
    picture_.close();
    return {};
}

}  // namespace

Expected<void> render_film(const ViewerConfig& configuration, std::stop_token stop) {
    ViewerConfig config = configuration;
    auto playback = Playback::open(config.recording.file, config.recording.path, config.bus);
    if (!playback) return tl::unexpected(playback.error());
    // The picture is drawn larger than the video by the factor of `supersample`.
    config.view.width *= config.video.supersample;
    config.view.height *= config.video.supersample;
    config.headless = true;
    auto surface = surface_options(config);
    if (!surface) return tl::unexpected(surface.error());
    auto display = Display::create(config.display);
    if (!display) return tl::unexpected(display.error());
    auto session = Session::create(config.bus, "film");
    if (!session) return tl::unexpected(session.error());
    (*session)->plays_offline();
    auto player = recording::Player::create((*playback)->file(), (*session)->participant(), {});
    if (!player) return tl::unexpected(player.error());
    Film film(config, std::move(*session), std::move(*player), std::move(*display));
    if (auto opened = film.open(*surface); !opened) return opened;
    return film.render(stop);
}

}  // namespace atrium::viewer
