#include "site_node/simulated_room/simulated_source.hpp"

#include "site_node/capture/pace.hpp"

#include <chrono>
#include <optional>
#include <vector>

namespace atrium::simulated_room {

SimulatedSource::SimulatedSource(config::Rig rig,
                                 const simulation::WrongCameras& wrong,
                                 const simulation::ChangingLight& light)
    : rig_(std::move(rig)), wrong_(wrong), light_(light), counters_(rig_) {}

Expected<std::unique_ptr<SimulatedSource>> SimulatedSource::create(
    const config::Rig& rig,
    const simulation::RoomOptions& room,
    const std::filesystem::path& cache,
    const simulation::LoopProgress& progress,
    std::stop_token stop,
    const simulation::WrongCameras& wrong,
    const simulation::ChangingLight& light) {
    std::unique_ptr<SimulatedSource> source(new SimulatedSource(rig, wrong, light));
    const std::vector<geometry::CalibratedCamera> cameras = wrong.rendered(rig.cameras);
    source->rig_.rate_hz = room.rate_hz;
    if (cache.empty()) {
        auto loop = simulation::render_loop(cameras, room, progress, stop);
        if (!loop) return tl::unexpected(loop.error());
        source->loop_ = std::move(*loop);
        return source;
    }
    auto cached = simulation::load_or_render_loop(cameras, room, cache, progress, stop);
    if (!cached) return tl::unexpected(cached.error());
    source->loop_ = std::move(cached->loop);
    source->cache_written_ = cached->written;
    if (cached->cache_problem) source->cache_problem_ = cached->cache_problem->message;
    return source;
}

std::vector<Expected<void>> SimulatedSource::show_background(
    const std::vector<std::size_t>& cameras, const BackgroundSink& sink, std::stop_token stop) {
    const auto show = [&](std::size_t camera) -> Expected<void> {
        for (const simulation::Picture& picture :
             loop_.empty_room[wrong_.rendered_index(camera, 0.0)]) {
            if (stop.stop_requested() || !sink(camera, simulation::view_of(picture))) break;
        }
        return {};
    };
    return capture::one_after_another(cameras, show, stop);
}

Expected<void> SimulatedSource::run(std::stop_token stop, const Sink& sink) {
    capture::Pace pace(std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / rig_.rate_hz)));
    const std::size_t num = loop_.frames.size();
    std::optional<capture::Pace::Clock::time_point> begin;
    for (std::size_t instant = 0; pace.wait(stop); instant = (instant + 1) % num) {
        simulation::copy_to_memory_if_wanted(loop_);
        const Timestamp now = pace.due_time();
        if (!begin) begin = pace.due();
        const double time_s = std::chrono::duration<double>(pace.due() - *begin).count();
        for (std::size_t camera = 0; camera < rig_.cameras.size(); ++camera) {
            counters_.count_received(camera);
            sink({camera,
                  now,
                  light_.lit(loop_.frames[wrong_.shown_instant(camera, instant, num)]
                                         [wrong_.rendered_index(camera, time_s)],
                             time_s),
                  nullptr});
        }
    }
    return {};
}

Expected<capture::CameraFrame> SimulatedSource::read_picture(std::size_t camera,
                                                             std::size_t index) {
    const std::size_t num = loop_.frames.size();
    const double time_s = static_cast<double>(index) / rig_.rate_hz;
    return capture::CameraFrame{
        camera,
        {},
        light_.lit(loop_.frames[wrong_.shown_instant(camera, index % num, num)]
                               [wrong_.rendered_index(camera, time_s)],
                   time_s),
        nullptr};
}

}  // namespace atrium::simulated_room
