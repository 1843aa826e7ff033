// The whole site pipeline, from pictures to coded mesh and textures, on a simulated room.

#include "core/base/thread_pool.hpp"
#include "site_node/pipeline.hpp"
#include "site_node/simulated_room/simulated_source.hpp"

#include <benchmark/benchmark.h>

#include <memory>

namespace atrium {
namespace {

// The full-body rig with each picture scaled to the given width.
config::Rig scaled_rig(int width) {
    auto rig = config::load_rig(ATRIUM_SOURCE_DIR "/deploy/rigs/full_body.toml");
    if (!rig) throw std::runtime_error(rig.error().message);
    for (auto& camera : rig->cameras) {
        geometry::PinholeCamera& k = camera.intrinsics;
        const double scale = static_cast<double>(width) / k.width;
        k.width = width;
        k.height = static_cast<int>(k.height * scale) & ~1;
        k.fx *= scale;
        k.fy *= scale;
        k.cx = (k.cx + 0.5) * scale - 0.5;
        k.cy = (k.cy + 0.5) * scale - 0.5;
    }
    return *rig;
}

struct Room {
    std::unique_ptr<simulated_room::SimulatedSource> source;
    std::vector<capture::Metaframe> metaframes;
};

Room make_room(int width) {
    simulation::RoomOptions options;
    options.motion = "push";
    options.loop_s = 1.0;
    options.rate_hz = 8.0;
    const config::Rig rig = scaled_rig(width);
    auto source = simulated_room::SimulatedSource::create(rig, options, {}, {}, {});
    if (!source) throw std::runtime_error(source.error().message);
    Room room{std::move(*source), {}};
    std::stop_source stop;
    (void)room.source->run(stop.get_token(), [&](capture::CameraFrame frame) {
        if (room.metaframes.empty() || room.metaframes.back().frames.size() == rig.cameras.size()) {
            if (room.metaframes.size() == 8) return stop.request_stop(), void();
            room.metaframes.emplace_back().frame_id = room.metaframes.size();
        }
        room.metaframes.back().frames.push_back(std::move(frame));
    });
    return room;
}

// args: picture width [px], workers
void BM_SitePipeline(benchmark::State& state) {
    const Room room = make_room(static_cast<int>(state.range(0)));
    auto pipeline = site_node::Pipeline::create(*room.source, {}, {});
    ThreadPool pool(static_cast<std::size_t>(state.range(1)));
    site_node::SiteFrame frame;
    site_node::SiteFrame::Milliseconds sum;
    std::size_t next = 0;
    std::size_t num_triangles = 0;
    for (auto _ : state) {
        const auto& metaframe = room.metaframes[next++ % room.metaframes.size()];
        if (auto done = pipeline->process(metaframe, pool, frame); !done)
            state.SkipWithError(done.error().message.c_str());
        sum.silhouettes += frame.milliseconds.silhouettes;
        sum.hull += frame.milliseconds.hull;
        sum.encode += frame.milliseconds.encode;
        num_triangles += frame.hull.mesh.triangles.size();
    }
    using benchmark::Counter;
    state.counters["silhouettes_ms"] = Counter(sum.silhouettes, Counter::kAvgIterations);
    state.counters["hull_ms"] = Counter(sum.hull, Counter::kAvgIterations);
    state.counters["encode_ms"] = Counter(sum.encode, Counter::kAvgIterations);
    state.counters["triangles"] =
        Counter(static_cast<double>(num_triangles), Counter::kAvgIterations);
}
BENCHMARK(BM_SitePipeline)
    ->ArgNames({"width_px", "workers"})
    ->Args({640, 1})
    ->Args({640, 2})
    ->Args({1152, 1})
    ->Args({1152, 2})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace atrium

BENCHMARK_MAIN();
