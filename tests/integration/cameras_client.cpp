// Watches a site's path from cameras to hulls. It runs beside simulated cameras that stamp their
// pictures, and checks what a site cannot know: that no metaframe mixes triggers, and that the site
// keeps running while cameras fail. Prints a table. Exits with 1 if a check fails.
//
//   simulated_cameras --rig RIG --stamp --stop cam2@20+10 -- cameras_client --rig RIG
//       --outages cam2=10

#include "core/app/log.hpp"
#include "core/app/program.hpp"
#include "core/base/latest_slot.hpp"
#include "core/base/statistics.hpp"
#include "core/base/thread_pool.hpp"
#include "site_node/capture/aravis_source.hpp"
#include "site_node/capture/metaframe_assembler.hpp"
#include "site_node/pipeline.hpp"
#include "tests/integration/cameras_watch.hpp"
#include "tools/simulated_cameras/camera_server.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <thread>

namespace atrium {
namespace {

using namespace cameras;

constexpr double kMaxGap_s = 2.0;  // of the site, and of a camera that returns

struct ClientConfig {
    std::filesystem::path rig;
    double rate_hz = 20.0;
    double seconds = 10.0;
    std::string trigger = "free-run";
    std::string pixel_format = "BayerRG8";
    int min_cameras = 6;
    int num_background_frames = 12;
    int threads = 1;
    int deadline_ms = 50;
    std::string outages;
    std::string lossy;
};

void declare(ClientConfig& config, config::OptionSet& set) {
    set.add("rig", config.rig, "the cameras");
    set.add("rate_hz", config.rate_hz, "metaframes per second [Hz]", {1, 240});
    set.add("seconds", config.seconds, "how long to watch [s]", {1, 1e6});
    set.add("trigger", config.trigger, "who triggers the cameras", {"free-run", "software"});
    set.add("pixel_format", config.pixel_format, "of the cameras");
    set.add("min_cameras", config.min_cameras, "enough for a hull", {2, 64});
    set.add("num_background_frames", config.num_background_frames, "to learn from", {2, 1000});
    set.add("threads", config.threads, "workers for segmentation and hull", {1, 64});
    set.add("deadline_ms", config.deadline_ms, "of a metaframe [ms]", {1, 10000});
    set.add("outages", config.outages, "cameras that go, and for how long [s]: CAMERA=SECONDS,...");
    set.add("lossy", config.lossy, "a camera that must have incomplete pictures");
}

struct Outage {
    std::size_t camera = 0;
    double seconds = 0.0;
};

std::optional<std::size_t> camera_index(const config::Rig& rig, std::string_view name) {
    for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
        if (rig.cameras[i].name == name) return i;
    }
    return std::nullopt;
}

std::vector<Outage> parse_outages(const std::string& text, const config::Rig& rig) {
    std::vector<Outage> outages;
    std::string_view rest = text;
    while (!rest.empty()) {
        const std::string_view item = rest.substr(0, rest.find(','));
        rest.remove_prefix(std::min(rest.size(), item.size() + 1));
        const std::size_t at = std::min(item.find('='), item.size());
        Outage outage;
        const auto camera = camera_index(rig, item.substr(0, at));
        if (!camera) continue;
        outage.camera = *camera;
        std::from_chars(
            item.data() + std::min(at + 1, item.size()), item.data() + item.size(), outage.seconds);
        outages.push_back(outage);
    }
    return outages;
}

void work(LatestSlot<capture::Metaframe>& metaframes,
          site_node::Pipeline& pipeline,
          int num_threads,
          std::stop_token stop,
          Output& output) {
    ThreadPool pool(static_cast<std::size_t>(num_threads));
    site_node::SiteFrame frame;
    auto last = Clock::now();
    while (const auto metaframe = metaframes.take(stop)) {
        if (const auto done = pipeline.process(*metaframe, pool, frame); !done) {
            ++output.num_failed;
            app::log::warn("metaframe failed reason=\"{}\"", done.error().message);
            continue;
        }
        const auto now = Clock::now();
        output.longest_gap_s = std::max(output.longest_gap_s, Seconds(now - last).count());
        last = now;
        ++output.num_published;
        const std::size_t num_triangles = frame.hull.mesh.triangles.size();
        output.num_with_hull += num_triangles > 0 ? 1 : 0;
        output.triangles.push_back(static_cast<double>(num_triangles));
        output.latencies_ms.push_back(
            std::chrono::duration<double, std::milli>(Timestamp::now() - frame.capture_time)
                .count());
    }
    output.longest_gap_s = std::max(output.longest_gap_s, Seconds(Clock::now() - last).count());
}

capture::CamerasOptions cameras_options(const ClientConfig& config, const config::Rig& rig) {
    capture::CamerasOptions options;
    for (const simulated_cameras::CameraIdentity& identity : simulated_cameras::identities_of(rig))
        options.cameras.push_back({identity.name, identity.serial, identity.address, {}});
    options.common.pixel_format = config.pixel_format;
    options.trigger = config.trigger == "software" ? capture::TriggerMode::kSoftware
                                                   : capture::TriggerMode::kFreeRun;
    options.deadline = std::chrono::milliseconds(config.deadline_ms);
    return options;
}

void print(const ClientConfig& config,
           const config::Rig& rig,
           const Watch& watch,
           const Output& output,
           const capture::AssemblerCounters& counters,
           const std::vector<capture::CameraCounters>& cameras) {
    fmt::print("{} cameras, {} x {}, {}, {} Hz, {}, {} s\n",
               rig.cameras.size(),
               rig.cameras.front().intrinsics.width,
               rig.cameras.front().intrinsics.height,
               config.pixel_format,
               config.rate_hz,
               config.trigger,
               config.seconds);
    const double stamps_per_trigger = config.trigger == "software" ? 1000.0 / config.rate_hz : 1.0;
    fmt::print("triggers     {:.0f} from the first to the last metaframe\n",
               watch.first_trigger
                   ? (*watch.last_trigger - *watch.first_trigger) / stamps_per_trigger + 1.0
                   : 0.0);
    fmt::print(
        "metaframes   {} complete, {} used without all cameras, {} dropped, {} stray pictures\n",
        counters.num_complete,
        counters.num_incomplete_used,
        counters.num_incomplete,
        counters.num_stray);
    fmt::print(
        "stamps       {} metaframes mix triggers, {} out of order, {} pictures unreadable, {} "
        "of another camera\n",
        watch.num_mixed,
        watch.num_backwards,
        watch.num_unreadable,
        watch.num_wrong_camera);
    fmt::print(
        "published    {}, with a hull {}, failed {}; longest gap {:.2f} s; latency {:.0f} ms, "
        "p99 {:.0f} ms; {:.0f} triangles\n",
        output.num_published,
        output.num_with_hull,
        output.num_failed,
        output.longest_gap_s,
        quantile(output.latencies_ms, 0.5),
        quantile(output.latencies_ms, 0.99),
        quantile(output.triangles, 0.5));
    fmt::print("{:<8} {:>7} {:>8} {:>10} {:>6} {:>5} {:>7} {:>9} {:>10} {:>15}\n",
               "camera",
               "seen",
               "received",
               "incomplete",
               "resent",
               "late",
               "dropped",
               "backwards",
               "reconnects",
               "longest absence");
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        const capture::CameraCounters& c = cameras[i];
        fmt::print("{:<8} {:>7} {:>8} {:>10} {:>6} {:>5} {:>7} {:>9} {:>10} {:>13.2f} s\n",
                   c.name,
                   watch.cameras[i].num_seen,
                   c.num_received,
                   c.num_incomplete,
                   c.num_resent,
                   c.num_late,
                   c.num_dropped,
                   c.num_backwards,
                   c.num_reconnects,
                   watch.cameras[i].longest_absence_s);
    }
}

// Failed checks, one per line.
std::vector<std::string> failures(const ClientConfig& config,
                                  const config::Rig& rig,
                                  const Watch& watch,
                                  const Output& output,
                                  const std::vector<capture::CameraCounters>& cameras) {
    std::vector<std::string> lines;
    const auto must = [&](bool holds, std::string line) {
        if (!holds) lines.push_back(std::move(line));
    };
    must(watch.num_mixed == 0, "metaframes mix triggers");
    must(watch.num_backwards == 0, "metaframes come out of order");
    must(watch.num_unreadable == 0, "pictures have no stamp, or two");
    must(watch.num_wrong_camera == 0, "pictures are of another camera");
    must(output.num_with_hull > 0, "there is no hull");
    must(output.longest_gap_s <= kMaxGap_s,
         fmt::format("nothing was published for {:.2f} s", output.longest_gap_s));
    const std::vector<Outage> outages = parse_outages(config.outages, rig);
    for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
        double allowed_s = kMaxGap_s;
        bool goes = false;
        for (const Outage& outage : outages) {
            if (outage.camera != i) continue;
            allowed_s = std::max(allowed_s, outage.seconds + kMaxGap_s);
            goes = true;
            must(watch.cameras[i].longest_absence_s >= outage.seconds,
                 rig.cameras[i].name + " was never away");
        }
        must(watch.cameras[i].longest_absence_s <= allowed_s,
             fmt::format("{} was missing for {:.2f} s, {:.2f} s are allowed",
                         rig.cameras[i].name,
                         watch.cameras[i].longest_absence_s,
                         allowed_s));
        if (goes) must(cameras[i].num_reconnects > 0, rig.cameras[i].name + " never reconnected");
    }
    if (const auto lossy = camera_index(rig, config.lossy)) {
        must(cameras[*lossy].num_incomplete > 0,
             config.lossy + " loses packets, and none of its pictures was counted as incomplete");
    }
    return lines;
}

Expected<int> run(const ClientConfig& config, std::stop_token stop) {
    auto rig = config::load_rig(config.rig);
    if (!rig) return tl::unexpected(rig.error());
    rig->rate_hz = config.rate_hz;
    auto source = capture::AravisSource::open(
        *rig,
        cameras_options(config, *rig),
        [](bool is_warning, const std::string& line) {
            app::log::write(is_warning ? app::log::Level::kWarn : app::log::Level::kInfo, line);
        },
        stop);
    if (!source) return tl::unexpected(source.error());
    site_node::PipelineOptions pipeline_options;
    pipeline_options.background.num_frames = config.num_background_frames;
    auto pipeline = site_node::Pipeline::create(**source, pipeline_options, stop);
    if (!pipeline) return tl::unexpected(pipeline.error());

    capture::AssemblerOptions options;
    options.tolerance =
        std::chrono::nanoseconds(static_cast<std::int64_t>(0.25e9 / config.rate_hz));
    options.deadline = std::chrono::milliseconds(config.deadline_ms);
    options.min_cameras = static_cast<std::size_t>(config.min_cameras);
    capture::MetaframeAssembler assembler(rig->cameras.size(), options);
    // stamps of software triggers are their time in ms
    const bool is_ours = config.trigger == "software";
    Watch watch(rig->cameras.size(),
                is_ours ? static_cast<std::uint32_t>(500.0 / config.rate_hz) : 0);
    Output output;
    LatestSlot<capture::Metaframe> metaframes;
    Expected<void> ran;
    {
        std::jthread worker(
            [&](std::stop_token s) { work(metaframes, *pipeline, config.threads, s, output); });
        const auto end = Clock::now() + Seconds(config.seconds);
        std::stop_source done;
        const std::stop_callback pass_on(stop, [&done] { done.request_stop(); });
        ran = (*source)->run(done.get_token(), [&](capture::CameraFrame frame) {
            if (Clock::now() >= end) done.request_stop();
            if (auto metaframe = assembler.add(std::move(frame), Clock::now())) {
                watch.look_at(*metaframe);
                metaframes.put(std::move(*metaframe));
            }
        });
        watch.finish();
    }
    if (!ran) return tl::unexpected(ran.error());
    const auto cameras = (*source)->camera_counters();
    print(config, *rig, watch, output, assembler.counters(), cameras);
    const auto lines = failures(config, *rig, watch, output, cameras);
    for (const std::string& line : lines) fmt::print("NOT AS IT MUST BE: {}\n", line);
    if (lines.empty()) fmt::print("all is as it must be\n");
    return lines.empty() ? 0 : 1;
}

}  // namespace
}  // namespace atrium

int main(int argc, char** argv) {
    using namespace atrium;
    ClientConfig config;
    config::OptionSet options;
    declare(config, options);
    const app::ProgramInfo info{
        "cameras_client", "Watches a site's way from simulated cameras to hulls.", ""};
    const app::Start start = app::start(info, options, argc, argv);
    if (!start.go_on) return start.exit_code;
    const app::StopOnSignal stop;
    const auto exit_code = run(config, stop.token());
    return exit_code ? *exit_code : app::fail(exit_code.error());
}
