#include "site_node/simulated_room/simulated_source.hpp"

#include "site_node/capture/pace.hpp"

namespace atrium::simulated_room {

SimulatedSource::SimulatedSource(config::Rig rig) : rig_(std::move(rig)), counters_(rig_) {}

Expected<std::unique_ptr<SimulatedSource>> SimulatedSource::create(
    const config::Rig& rig,
    const simulation::RoomOptions& room,
    const std::filesystem::path& cache,
    const simulation::LoopProgress& progress,
    std::stop_token stop) {
    std::unique_ptr<SimulatedSource> source(new SimulatedSource(rig));
    source->rig_.rate_hz = room.rate_hz;
    if (cache.empty()) {
        auto loop = simulation::render_loop(rig.cameras, room, progress, stop);
        if (!loop) return tl::unexpected(loop.error());
        source->loop_ = std::move(*loop);
        return source;
    }
    auto cached = simulation::load_or_render_loop(rig.cameras, room, cache, progress, stop);
    if (!cached) return tl::unexpected(cached.error());
    source->loop_ = std::move(cached->loop);
    source->cache_written_ = cached->written;
    if (cached->cache_problem) source->cache_problem_ = cached->cache_problem->message;
    return source;
}

std::vector<Expected<void>> SimulatedSource::show_background(
    const std::vector<std::size_t>& cameras, const BackgroundSink& sink, std::stop_token stop) {
    const auto show = [&](std::size_t camera) -> Expected<void> {
        for (const simulation::Picture& picture : loop_.empty_room[camera]) {
            if (stop.stop_requested() || !sink(camera, simulation::view_of(picture))) break;
        }
        return {};
    };
    return capture::one_after_another(cameras, show, stop);
}

Expected<void> SimulatedSource::run(std::stop_token stop, const Sink& sink) {
    capture::Pace pace(std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / rig_.rate_hz)));
    for (std::size_t instant = 0; pace.wait(stop); instant = (instant + 1) % loop_.frames.size()) {
        simulation::copy_to_memory_if_wanted(loop_);
        const Timestamp now = pace.due_time();
        for (std::size_t camera = 0; camera < rig_.cameras.size(); ++camera) {
            counters_.count_received(camera);
            sink({camera, now, loop_.frames[instant][camera], nullptr});
        }
    }
    return {};
}

}  // namespace atrium::simulated_room
