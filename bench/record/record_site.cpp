// What recording costs a site: eight cameras of one megapixel at 30 Hz on two cores, with and
// without a recorder. Writes comma-separated values, which record_site.sh keeps.

#include "bench/site/site_run.hpp"
#include "bench/value_of.hpp"
#include "core/app/log.hpp"
#include "site_node/record/raw_recorder.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace atrium::bench {
namespace {

constexpr double kRate_hz = 30.0;
constexpr std::size_t kWorkers = 2;

struct RecordCase {
    const char* name;
    std::optional<capture::RawCodec> codec;  // empty: nothing is recorded
    int num_threads = 1;
};

const RecordCase kCases[] = {
    {"off", std::nullopt},
    {"raw", capture::RawCodec::kRaw},
    {"huffyuv", capture::RawCodec::kHuffYuv, 2},
    {"ffv1", capture::RawCodec::kFfv1, 2},
};

std::unique_ptr<record::RawRecorder> open_recorder(const SiteScene& scene,
                                                   const site_node::Pipeline& pipeline,
                                                   const RecordCase& c) {
    record::RecordedRoom room{"bench", scene.rig(), {}, ""};
    for (std::size_t i = 0; i < room.rig.cameras.size(); ++i)
        room.rooms.push_back(pipeline.room(i));
    record::RecorderOptions options;
    options.codec = *c.codec;
    options.rate_hz = kRate_hz;
    options.bytes_per_instant = room.rig.cameras.size() * 1'000'000;
    options.num_threads = c.num_threads;
    return value_of(record::RawRecorder::create(std::move(room), options));
}

void measure(SiteScene& scene,
             site_node::Pipeline& pipeline,
             const RecordCase& c,
             const std::filesystem::path& folder,
             double seconds) {
    using Clock = std::chrono::steady_clock;
    std::filesystem::remove_all(folder);
    std::unique_ptr<record::RawRecorder> recorder;
    if (c.codec) {
        recorder = open_recorder(scene, pipeline, c);
        require(recorder->start(folder));
    }
    SiteRun run(scene, pipeline, kWorkers, [&](const capture::CameraFrame& frame) {
        if (recorder) recorder->add(frame);
    });
    const auto begin = Clock::now();
    run.run(kRate_hz, seconds);
    record::RecordedPictures sum;
    double drain_s = 0.0;
    if (recorder) {
        const auto stopped = Clock::now();
        require(recorder->stop());
        drain_s = std::chrono::duration<double>(Clock::now() - stopped).count();
        for (const record::RecordedPictures& camera : recorder->counters()) {
            sum.num_written += camera.num_written;
            sum.num_dropped += camera.num_dropped;
            sum.num_bytes += camera.num_bytes;
            sum.num_raw_bytes += camera.num_raw_bytes;
        }
    }
    const double all_s = std::chrono::duration<double>(Clock::now() - begin).count();
    const auto ready = static_cast<double>(run.num_ready());
    fmt::print("{},{:.0f},{},{:.1f},{},{},{:.2f},{:.1f},{:.1f},{:.2f},{},{},{:.1f},{:.3f},{:.2f}\n",
               c.name,
               kRate_hz,
               c.num_threads,
               seconds,
               run.num_ready(),
               run.num_late(),
               ready / run.seconds(),
               run.latency_ms(0.5),
               run.latency_ms(0.99),
               1e-3 * run.core_ms() * ready / run.seconds(),
               sum.num_written,
               sum.num_dropped,
               1e-6 * static_cast<double>(sum.num_bytes) / all_s,
               sum.num_raw_bytes == 0
                   ? 0.0
                   : static_cast<double>(sum.num_bytes) / static_cast<double>(sum.num_raw_bytes),
               drain_s);
    std::fflush(stdout);
    recorder.reset();
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace atrium::bench

int main(int argc, char** argv) {
    using namespace atrium;
    if (argc != 3 || std::atof(argv[2]) <= 0.0) {
        std::fputs("usage: record_site FOLDER SECONDS of each case\n", stderr);
        return 2;
    }
    app::log::set_level("warn");
    bench::SiteScene scene = bench::value_of(bench::SiteScene::create({}));
    site_node::Pipeline pipeline = bench::value_of(site_node::Pipeline::create(scene, {}, {}));
    fmt::print(
        "codec,offered_hz,threads,seconds,ready,late,rate_hz,median_ms,p99_ms,cores,written,"
        "dropped,"
        "mb_per_s,of_raw,drain_s\n");
    for (const bench::RecordCase& c : bench::kCases)
        bench::measure(
            scene, pipeline, c, std::filesystem::path(argv[1]) / "recording", std::atof(argv[2]));
}
