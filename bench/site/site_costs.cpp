// What the work of a site costs on one core of this machine, for `atrium plan`: TOML on standard
// output. One person, whom every camera sees whole, as in bench/scenes.

#include "bench/hull/hull_scenes.hpp"
#include "bench/scenes/site_scene.hpp"
#include "core/base/executor.hpp"
#include "core/base/median.hpp"
#include "core/base/thread_pool.hpp"
#include "core/bus/bus.hpp"
#include "site_node/pipeline.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

namespace atrium::bench {
namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

// y = fixed + slope * x, least squares.
struct Line {
    double fixed = 0.0;
    double slope = 0.0;
};
Line fit(const std::vector<double>& x, const std::vector<double>& y) {
    double mean_x = 0.0;
    double mean_y = 0.0;
    const auto n = static_cast<double>(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        mean_x += x[i] / n;
        mean_y += y[i] / n;
    }
    double up = 0.0;
    double down = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        up += (x[i] - mean_x) * (y[i] - mean_y);
        down += (x[i] - mean_x) * (x[i] - mean_x);
    }
    const double slope = up / down;
    return {mean_y - slope * mean_x, slope};
}

// Costs of one picture, medians.
struct PictureCosts {
    double mp = 0.0;
    double silhouette_ms = 0.0;
    double texture_ms = 0.0;
    double texture_bytes = 0.0;
    double segments = 0.0;
    double mesh_ms_per_ktriangle = 0.0;
    double mesh_bytes_per_triangle = 0.0;
    double triangles_per_segment = 0.0;
};

Expected<PictureCosts> measure_pictures(int side_px) {
    SiteSceneOptions options;
    options.side_px = side_px;
    auto scene = SiteScene::create(options);
    if (!scene) return tl::unexpected(scene.error());
    auto pipeline = site_node::Pipeline::create(*scene, {}, {});
    if (!pipeline) return tl::unexpected(pipeline.error());
    const std::size_t num_cameras = scene->rig().cameras.size();
    SerialExecutor serial;
    site_node::Pipeline::Silhouettes silhouettes;
    site_node::SiteFrame frame;
    std::vector<double> silhouette_ms;
    std::vector<double> texture_ms;
    std::vector<double> bytes;
    std::vector<double> segments;
    std::vector<double> mesh_ms;
    std::vector<double> mesh_bytes;
    std::vector<double> triangles;
    const auto per_camera = 1.0 / static_cast<double>(num_cameras);
    for (int instant = 0; instant < 60; ++instant) {
        capture::Metaframe metaframe;
        metaframe.frame_id = static_cast<std::uint64_t>(instant);
        metaframe.capture_time = Timestamp::now();
        for (std::size_t camera = 0; camera < num_cameras; ++camera)
            metaframe.frames.push_back({camera,
                                        metaframe.capture_time,
                                        scene->picture(static_cast<std::size_t>(instant), camera),
                                        nullptr});
        if (auto found = pipeline->find_silhouettes(metaframe, serial, silhouettes); !found)
            return tl::unexpected(found.error());
        if (auto done = pipeline->compute(silhouettes, {}, serial, frame); !done)
            return tl::unexpected(done.error());
        if (instant < 10) continue;  // memory grows, and the light is learned
        std::size_t num_segments = 0;
        for (const auto& view : pipeline->views(silhouettes)) {
            for (const auto& contour : view.view.contours) num_segments += contour.size();
        }
        std::size_t num_bytes = 0;
        for (const auto& camera : frame.cameras)
            num_bytes += camera.texture.colour.size() + camera.texture.mask.size();
        const auto& work = frame.work_milliseconds;
        const auto num_triangles = static_cast<double>(frame.hull.mesh.triangles.size());
        silhouette_ms.push_back(per_camera * (work.segmentation + work.polygons));
        texture_ms.push_back(per_camera * work.textures);
        bytes.push_back(per_camera * static_cast<double>(num_bytes));
        segments.push_back(per_camera * static_cast<double>(num_segments));
        mesh_ms.push_back(1e3 * work.mesh / num_triangles);
        mesh_bytes.push_back(static_cast<double>(frame.draco.size()) / num_triangles);
        triangles.push_back(num_triangles / static_cast<double>(num_segments));
    }
    return PictureCosts{1e-6 * side_px * side_px,
                        median_of(silhouette_ms),
                        median_of(texture_ms),
                        median_of(bytes),
                        median_of(segments),
                        median_of(mesh_ms),
                        median_of(mesh_bytes),
                        median_of(triangles)};
}

double hull_ms(const std::vector<hull::SilhouetteView>& views, Executor& executor) {
    hull::HullScratch scratch;
    hull::VisualHull hull;
    double least = std::numeric_limits<double>::infinity();
    for (int round = 0; round < 6; ++round) {
        const auto begin = Clock::now();
        hull::compute_visual_hull(views, {}, scratch, executor, hull);
        if (round > 0) least = std::min(least, ms_since(begin));
    }
    return least;
}

double processor_ms() {
    rusage use{};
    getrusage(RUSAGE_SELF, &use);
    return 1e3 * static_cast<double>(use.ru_utime.tv_sec + use.ru_stime.tv_sec) +
           1e-3 * static_cast<double>(use.ru_utime.tv_usec + use.ru_stime.tv_usec);
}

constexpr int kNumMessages = 1000;
constexpr std::array<std::size_t, 2> kVertices{300, 6000};  // as one camera and a region have
constexpr double kBytesPerVertex = 16.0;

// Takes kNumMessages silhouettes of each size. Returns the processor time between the first and the
// last one of each.
std::array<double, kVertices.size()> take_messages(const bus::BusOptions& options) {
    auto participant = bus::Participant::create(options);
    auto reader = bus::Reader<bus::CameraSilhouette>::create(*participant);
    auto waiter = bus::Waiter::create(*participant);
    waiter->add(*reader);
    std::array<double, kVertices.size()> first_ms{};
    std::array<double, kVertices.size()> last_ms{};
    std::array<int, kVertices.size()> num_taken{};
    while (num_taken.back() < kNumMessages && waiter->wait(std::chrono::seconds(20))) {
        reader->take([&](bus::CameraSilhouette&& silhouette) {
            const std::size_t size = silhouette.vertices_px.size() == kVertices[0] ? 0 : 1;
            last_ms[size] = processor_ms();
            if (num_taken[size]++ == 0) first_ms[size] = last_ms[size];
        });
    }
    return {last_ms[0] - first_ms[0], last_ms[1] - first_ms[1]};
}

// Processor time to write one silhouette here and to take it in another process, over its
// kilobytes.
Expected<Line> message_ms() {
    bus::BusOptions options;
    options.world = fmt::format("costs-{}", getpid());
    int result[2] = {};
    if (pipe(result) != 0) return make_error(ErrorKind::kUnavailable, "no pipe");
    const pid_t pid = fork();
    if (pid == 0) {
        const auto taken_ms = take_messages(options);
        _exit(write(result[1], &taken_ms, sizeof(taken_ms)) == sizeof(taken_ms) ? 0 : 1);
    }
    auto participant = bus::Participant::create(options);
    if (!participant) return tl::unexpected(participant.error());
    auto writer = bus::Writer<bus::CameraSilhouette>::create(*participant);
    if (!writer) return tl::unexpected(writer.error());
    bus::CameraSilhouette silhouette;
    silhouette.site = "hall";
    silhouette.host = "left";
    while (writer->num_readers() == 0) usleep(10'000);
    std::array<double, kVertices.size()> written_ms{};
    for (std::size_t size = 0; size < kVertices.size(); ++size) {
        silhouette.contour_sizes = {static_cast<std::uint32_t>(kVertices[size])};
        silhouette.vertices_px.assign(kVertices[size], {1.0, 2.0});
        const double before = processor_ms();
        for (int i = 0; i < kNumMessages; ++i) {
            if (auto written = writer->write(silhouette); !written)
                return tl::unexpected(written.error());
            usleep(4'000);
        }
        written_ms[size] = processor_ms() - before;
    }
    std::array<double, kVertices.size()> taken_ms{};
    const bool is_told = read(result[0], &taken_ms, sizeof(taken_ms)) == sizeof(taken_ms);
    waitpid(pid, nullptr, 0);
    if (!is_told) return make_error(ErrorKind::kInternal, "the reader of silhouettes failed");
    std::vector<double> kilobytes;
    std::vector<double> each_ms;
    for (std::size_t size = 0; size < kVertices.size(); ++size) {
        kilobytes.push_back(1e-3 * kBytesPerVertex * static_cast<double>(kVertices[size]));
        each_ms.push_back((written_ms[size] + taken_ms[size]) / kNumMessages);
    }
    return fit(kilobytes, each_ms);
}

int run() {
    // first: it forks, which goes badly with threads
    const auto message = message_ms();
    if (!message) return fmt::print(stderr, "{}\n", message.error().message), 1;
    std::vector<PictureCosts> costs;
    for (const int side_px : {560, 1000, 1440}) {
        const auto measured = measure_pictures(side_px);
        if (!measured) return fmt::print(stderr, "{}\n", measured.error().message), 1;
        costs.push_back(*measured);
        fmt::print(stderr, "pictures of {} px measured\n", side_px);
    }
    const auto column = [&](double PictureCosts::*field) {
        std::vector<double> values;
        for (const PictureCosts& each : costs) values.push_back(each.*field);
        return values;
    };
    const std::vector<double> mp = column(&PictureCosts::mp);
    const Line silhouette = fit(mp, column(&PictureCosts::silhouette_ms));
    const Line texture = fit(mp, column(&PictureCosts::texture_ms));
    const Line bytes = fit(mp, column(&PictureCosts::texture_bytes));
    std::vector<double> sides;
    for (const double each : mp) sides.push_back(std::sqrt(each));
    const Line segments = fit(sides, column(&PictureCosts::segments));

    SerialExecutor serial;
    std::vector<double> log_views;
    std::vector<double> log_us;
    std::string table;
    for (const int views : {8, 16, 24, 32, 48, 64}) {
        const auto scene = person_views(views, 250);
        const double ms = hull_ms(scene, serial);
        const double us_per_segment = 1e3 * ms / static_cast<double>(num_segments(scene));
        log_views.push_back(std::log(views));
        log_us.push_back(std::log(us_per_segment));
        table +=
            fmt::format("# {} views, {} segments: {:.1f} ms\n", views, num_segments(scene), ms);
        fmt::print(stderr, "hull of {} views measured\n", views);
    }
    const Line growth = fit(log_views, log_us);
    ThreadPool two(2);
    const auto scene = person_views(16, 250);
    double one_ms = std::numeric_limits<double>::infinity();
    double two_ms = one_ms;
    for (int round = 0; round < 6; ++round) {  // in turn: a disturbance meets both
        one_ms = std::min(one_ms, hull_ms(scene, serial));
        two_ms = std::min(two_ms, hull_ms(scene, two));
    }

    fmt::print(
        "[picture]  # one person whom the camera sees whole; mp: megapixels of the picture\n");
    fmt::print(
        "silhouette_ms = [{:.3f}, {:.3f}]  # fixed, per mp\n", silhouette.fixed, silhouette.slope);
    fmt::print("texture_ms = [{:.3f}, {:.3f}]  # fixed, per mp\n", texture.fixed, texture.slope);
    fmt::print("texture_bytes = [{:.0f}, {:.0f}]  # fixed, per mp\n", bytes.fixed, bytes.slope);
    fmt::print("segments = [{:.1f}, {:.1f}]  # fixed, per square root of mp\n\n",
               segments.fixed,
               segments.slope);
    fmt::print("[hull]  # time = segments of all views * us_per_segment * views ^ power\n{}",
               table);
    fmt::print("us_per_segment = {:.4f}\n", std::exp(growth.fixed));
    fmt::print("power = {:.3f}\n", growth.slope);
    fmt::print("two_threads = {:.2f}  # times as fast as one\n\n", one_ms / two_ms);
    fmt::print("[mesh]\n");
    fmt::print("triangles_per_segment = {:.2f}\n", costs[1].triangles_per_segment);
    fmt::print("ms_per_ktriangle = {:.3f}\n", costs[1].mesh_ms_per_ktriangle);
    fmt::print("bytes_per_triangle = {:.2f}\n\n", costs[1].mesh_bytes_per_triangle);
    fmt::print("[message]\n");
    fmt::print("ms = [{:.3f}, {:.4f}]  # processor time to write and take one: fixed, per kB\n",
               message->fixed,
               message->slope);
    return 0;
}

}  // namespace
}  // namespace atrium::bench

int main() { return atrium::bench::run(); }
