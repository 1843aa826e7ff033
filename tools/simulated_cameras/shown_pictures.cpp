#include "tools/simulated_cameras/shown_pictures.hpp"

#include "site_node/capture/recording_source.hpp"
#include "tools/simulated_cameras/sensor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace atrium::simulated_cameras {
namespace {

tl::unexpected<Error> stopped() {
    return make_error(ErrorKind::kUnavailable, "simulated cameras: loading was stopped");
}

std::vector<std::uint8_t> rendered_picture(const ShownPictures& shown,
                                           std::size_t rendered,
                                           double time_s) {
    image::YuvImage picture;
    shown.rendered->render(time_s, rendered, picture.y);
    // grey light: every filter of a mosaic passes the same
    if (shown.format != image::PixelFormat::kRgb) return std::move(picture.y.data);
    picture.u = image::Plane(picture.y.width / 2, picture.y.height / 2, 128);
    picture.v = picture.u;
    return sense(picture, shown.format);
}

}  // namespace

Expected<ShownPictures> show_room(const config::Rig& rig,
                                  const simulation::RoomConfig& config,
                                  image::PixelFormat format,
                                  const simulation::LoopProgress& progress,
                                  std::stop_token stop) {
    const auto wrong = simulation::WrongCameras::create(config, rig.cameras);
    if (!wrong) return tl::unexpected(wrong.error());
    config::Rig rendered = rig;
    rendered.cameras = wrong->rendered(rig.cameras);
    const std::vector<std::vector<std::vector<std::uint8_t>>> none(rendered.cameras.size());
    ShownPictures shown{.rig = rig,
                        .format = format,
                        .empty = none,
                        .motion = none,
                        .rendered = {},
                        .wrong = *wrong,
                        .light = simulation::changing_light(config)};
    shown.rendered = simulation::rendered_room(rendered, config);
    if (shown.rendered != nullptr) return shown;
    const simulation::RoomOptions room = simulation::room_options(config, rig.rate_hz);
    simulation::SimulatedLoop loop;
    if (config.cache.empty()) {
        auto made = simulation::render_loop(rendered.cameras, room, progress, stop);
        if (!made) return tl::unexpected(made.error());
        loop = std::move(*made);
    } else {
        auto cached =
            simulation::load_or_render_loop(rendered.cameras, room, config.cache, progress, stop);
        if (!cached) return tl::unexpected(cached.error());
        loop = std::move(cached->loop);
    }
    for (std::size_t camera = 0; camera < rendered.cameras.size(); ++camera) {
        for (const simulation::Picture& picture : loop.empty_room[camera])
            shown.empty[camera].push_back(sense(simulation::view_of(picture), format));
        loop.empty_room[camera].clear();  // pictures are large: one form at a time
    }
    for (std::vector<simulation::Picture>& instant : loop.frames) {
        for (std::size_t camera = 0; camera < rendered.cameras.size(); ++camera)
            shown.motion[camera].push_back(sense(simulation::view_of(instant[camera]), format));
        instant.clear();
    }
    return shown;
}

std::span<const std::uint8_t> picture_of(const ShownPictures& shown,
                                         std::size_t camera,
                                         const ShowSchedule::Choice& choice,
                                         std::vector<std::uint8_t>& memory) {
    const std::size_t rendered = shown.wrong.rendered_index(camera, choice.time_s);
    if (shown.rendered != nullptr) {
        const double instant =
            static_cast<double>(choice.index) - shown.wrong.late_instants(camera);
        memory = rendered_picture(shown, rendered, instant / shown.rig.rate_hz);
        return memory;
    }
    if (choice.is_empty_room) return shown.empty[rendered][choice.index];
    const auto& motion = shown.motion[rendered];
    const auto& picture = motion[shown.wrong.shown_instant(camera, choice.index, motion.size())];
    if (shown.light.stays()) return picture;
    memory = picture;
    shown.light.light(memory, choice.time_s);
    return memory;
}

Expected<ShownPictures> show_recording(const std::filesystem::path& folder,
                                       image::PixelFormat format,
                                       std::stop_token stop) {
    auto source = capture::RecordingSource::open({folder, 0.0, false});
    if (!source) return tl::unexpected(source.error());
    const config::Rig& rig = (*source)->rig();
    ShownPictures shown{.rig = rig, .format = format, .empty = {}, .motion = {}, .rendered = {}};
    shown.empty.resize(rig.cameras.size());
    shown.motion.resize(rig.cameras.size());
    std::vector<std::size_t> all(rig.cameras.size());
    std::iota(all.begin(), all.end(), 0);
    const auto keep = [&](std::size_t camera, const image::YuvView& picture) {
        shown.empty[camera].push_back(sense(picture, format));
        return true;
    };
    for (const auto& shows : (*source)->show_background(all, keep, stop)) {
        if (!shows && shows.error().kind != ErrorKind::kNotFound)
            return tl::unexpected(shows.error());
    }
    std::size_t num_bytes = 0;
    image::YuvImage buffer;
    for (std::size_t i = 0; i < (*source)->num_frames(); ++i) {
        if (stop.stop_requested()) return stopped();
        auto metaframe = (*source)->read_frame(i);
        if (!metaframe) {
            // a video header may announce more frames than the file has
            if (i > 0) break;
            return tl::unexpected(metaframe.error());
        }
        for (const capture::CameraFrame& frame : metaframe->frames) {
            shown.motion[frame.camera].push_back(
                sense(image::working_view(frame.image, buffer), format));
            num_bytes += shown.motion[frame.camera].back().size();
        }
        if (num_bytes > kMaxShownBytes) {
            return make_error(
                ErrorKind::kConfiguration,
                fmt::format("recording '{}': more than {} GB of pictures; serve a part of it",
                            folder.string(),
                            kMaxShownBytes >> 30));
        }
    }
    return shown;
}

ShowSchedule::ShowSchedule(std::size_t num_empty,
                           std::size_t num_instants,
                           double rate_hz,
                           std::chrono::microseconds empty_time)
    : num_empty_(num_empty),
      num_instants_(num_instants),
      rate_hz_(rate_hz),
      empty_time_(num_empty == 0 ? std::chrono::microseconds(0) : empty_time) {}

ShowSchedule::Choice ShowSchedule::at(std::int64_t time_us) {
    std::int64_t since_us = 0;
    double time_s = 0.0;
    {
        const std::lock_guard lock(mutex_);
        if (!begin_us_) begin_us_ = time_us;
        time_s = 1e-6 * static_cast<double>(time_us - *begin_us_);
        if (!empty_from_us_) empty_from_us_ = time_us;
        since_us = time_us - *empty_from_us_;
    }
    // a camera that lags behind the first one by a trigger or more also sees the beginning
    since_us = std::max<std::int64_t>(since_us, 0);
    // nearest instant: camera periods are whole microseconds, that of the motion is not
    const auto frames_after = [&](std::int64_t us) {
        return static_cast<std::size_t>(std::lround(static_cast<double>(us) * 1e-6 * rate_hz_));
    };
    if (since_us < empty_time_.count()) return {true, frames_after(since_us) % num_empty_, time_s};
    return {false, frames_after(since_us - empty_time_.count()) % num_instants_, time_s};
}

void ShowSchedule::empty_room(std::int64_t time_us) {
    const std::lock_guard lock(mutex_);
    empty_from_us_ = time_us;
}

TriggerNumbers::Trigger TriggerNumbers::free_running(std::int64_t now_us, std::int64_t period_us) {
    const std::int64_t number = now_us / period_us;
    return {static_cast<std::uint32_t>(number), number * period_us};
}

TriggerNumbers::Trigger TriggerNumbers::software(std::size_t camera,
                                                 std::int64_t now_us,
                                                 std::int64_t period_us) {
    const std::lock_guard lock(mutex_);
    const bool has_taken_part = last_[camera] == current_.number;
    if (has_taken_part || now_us - current_.time_us > period_us / 2)
        current_ = {current_.number + 1, now_us};
    last_[camera] = current_.number;
    return {static_cast<std::uint32_t>(now_us / 1000), current_.time_us};
}

}  // namespace atrium::simulated_cameras
