// Simulated sweeps of a wand with and without faults: is each fault found and named, is no good
// sweep refused, and how long does it take?
//
//     wand_trials trials [SEEDS [GOOD]]    CSV: fault, runs, refused, named, median seconds
//     wand_trials times                    CSV: cameras, instants, seconds, errors
#include "bench/calibrate/fault_trials.hpp"
#include "tests/unit/calibrate/swept_room.hpp"
#include "tools/calibrate/report/previous_rig.hpp"
#include "tools/calibrate/wand/judge_wand.hpp"
#include "tools/calibrate/wand/measure_wand.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <random>
#include <string>
#include <thread>
#include <vector>

namespace {

using namespace atrium;
using namespace atrium::calibrate;
using calibrate_test::sweep;
using calibrate_test::SweepOptions;
using calibrate_test::SweptRoom;

struct Run {
    SweepOptions options;
    Wand wand = default_wand();  // as the file says
    std::size_t camera = 0;      // that the fault is about
    std::function<void(SweptRoom&)> spoil;
    config::Rig before;                 // empty: none
    std::vector<std::string> expected;  // one of these must be said
};

struct Fault {
    const char* name;
    std::function<void(Run&, std::mt19937&)> make;
};

std::string quoted(std::size_t camera) { return fmt::format("'cam{}'", camera); }

// The points of another sweep of the same room, from an instant on.
void replace_points(SweptRoom& room,
                    const SweepOptions& options,
                    std::size_t camera,
                    std::uint32_t from) {
    auto& points = room.points[camera].points;
    std::erase_if(points, [&](const LightPoint& point) { return point.instant >= from; });
    const SweptRoom other = sweep(default_wand(), options);
    for (const LightPoint& point : other.points[camera].points)
        if (point.instant >= from) points.push_back(point);
}

const std::vector<Fault>& faults() {
    static const std::vector<Fault> all{
        {"one picture late",
         [](Run& run, std::mt19937& rng) {
             const double late = rng() % 2 == 0 ? 1.0 : -1.0;
             run.options.late_instants.assign(run.options.num_cameras, 0.0);
             run.options.late_instants[run.camera] = late;
             run.expected = {fmt::format(
                 "camera {} is {} by ", quoted(run.camera), late > 0.0 ? "late" : "early")};
         }},
        {"two cameras of one serial",
         [](Run& run, std::mt19937&) {
             const std::size_t other = (run.camera + 1) % run.options.num_cameras;
             run.spoil = [a = run.camera, other](SweptRoom& room) {
                 room.points[other].points = room.points[a].points;
             };
             run.expected = {"have the same pictures"};
         }},
        {"a camera that sees little",
         [](Run& run, std::mt19937&) {
             run.spoil = [a = run.camera](SweptRoom& room) {
                 std::erase_if(room.points[a].points,
                               [](const LightPoint& point) { return point.instant > 10; });
             };
             run.expected = {fmt::format("camera {} shows only", quoted(run.camera)),
                             fmt::format("no place found for {}", quoted(run.camera))};
         }},
        {"one light of the wand's file 20 mm off",
         [](Run& run, std::mt19937&) {
             run.wand.lights_m[1].x() += 0.02;
             run.expected = {"light 1 of the wand is seen", "show lights at the distances that"};
         }},
        {"all lengths of the wand's file off (the rig before is known)",
         [](Run& run, std::mt19937& rng) {
             const double off = 0.03 + 0.01 * static_cast<double>(rng() % 5);
             for (Eigen::Vector3d& light : run.wand.lights_m) light *= 1.0 + off;
             run.before.cameras = sweep(default_wand(), run.options).cameras;
             run.expected = {
                 fmt::format("all distances between cameras are {:.1f} % longer", 100.0 * off)};
         }},
        {"names of two cameras exchanged (the rig before is known)",
         [](Run& run, std::mt19937&) {
             const std::size_t other = (run.camera + 2) % run.options.num_cameras;
             run.before.cameras = sweep(default_wand(), run.options).cameras;
             run.spoil = [a = run.camera, other](SweptRoom& room) {
                 std::swap(room.points[a].points, room.points[other].points);
             };
             run.expected = {fmt::format("cameras {} and {} stand in each other's place",
                                         quoted(std::min(run.camera, other)),
                                         quoted(std::max(run.camera, other)))};
         }},
        {"pictures of one camera mirrored",
         [](Run& run, std::mt19937&) {
             run.spoil = [a = run.camera](SweptRoom& room) {
                 for (LightPoint& point : room.points[a].points)
                     point.px.x() = room.nominal[a].width - 1 - point.px.x();
             };
             run.expected = {fmt::format("camera {} contradicts", quoted(run.camera)),
                             fmt::format("no place found for {}", quoted(run.camera))};
         }},
        {"a camera of another sweep",
         [](Run& run, std::mt19937&) {
             run.spoil = [run](SweptRoom& room) {
                 SweepOptions other = run.options;
                 other.sweep_seed += 1000;
                 replace_points(room, other, run.camera, 0);
             };
             run.expected = {fmt::format("camera {} contradicts", quoted(run.camera)),
                             fmt::format("no place found for {}", quoted(run.camera))};
         }},
        {"a camera bumped in the middle of the sweep",
         [](Run& run, std::mt19937&) {
             run.spoil = [run](SweptRoom& room) {
                 SweepOptions bumped = run.options;
                 bumped.change = [&](std::vector<geometry::CalibratedCamera>& cameras) {
                     auto& pose = cameras[run.camera].camera_from_site;
                     const Eigen::AngleAxisd turn(0.01, Eigen::Vector3d(0.6, 0.8, 0.0));
                     pose = geometry::RigidTransform{Eigen::Quaterniond(turn),
                                                     Eigen::Vector3d::Zero()} *
                            pose;
                 };
                 replace_points(room, bumped, run.camera, run.options.num_instants / 2);
             };
             run.expected = {fmt::format("camera {} contradicts", quoted(run.camera))};
         }},
    };
    return all;
}

WandOptions how() {
    WandOptions options;
    options.num_threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    return options;
}

// All that would keep a rig from being written.
std::vector<std::string> problems_of(const Run& run) {
    SweptRoom room = sweep(default_wand(), run.options);
    if (run.spoil) run.spoil(room);
    if (const std::string twins = same_pictures(room.points); !twins.empty()) return {twins};
    const auto solution = solve_wand(run.wand, room.nominal, room.points, how());
    if (!solution) return {solution.error().message};
    std::vector<std::string> problems = judge_wand(*solution, run.options.rate_hz).problems;
    if (!run.before.cameras.empty()) {
        config::Rig solved;
        for (const BundleCamera& camera : solution->bundle.cameras)
            solved.cameras.push_back(
                {camera.name, camera.intrinsics(), camera.camera_from_world()});
        const ComparisonVerdict verdict = judge_against({"before.toml", run.before, true},
                                                        compare_rigs(run.before, solved),
                                                        solution->bundle,
                                                        solved);
        problems.insert(problems.end(), verdict.problems.begin(), verdict.problems.end());
    }
    return problems;
}

void try_fault(const char* name, const std::function<void(Run&, std::mt19937&)>& make, int seeds) {
    bench::print_trials(name, seeds, [&](std::uint32_t seed) {
        std::mt19937 rng(seed);
        Run run;
        run.options.seed = seed;
        run.options.sweep_seed = seed + 100;
        run.options.num_cameras = 5 + rng() % 4;
        run.options.num_instants = 200;
        run.camera = rng() % run.options.num_cameras;
        if (make) make(run, rng);
        bench::Trial trial;
        trial.seconds = bench::seconds_of([&] { trial.problems = problems_of(run); });
        trial.expected = run.expected;
        return trial;
    });
}

// What a perfect calibration would have found.
BundleCamera true_camera(const geometry::CalibratedCamera& truth, BundleCamera camera) {
    camera.set_camera_from_world(truth.camera_from_site);
    const geometry::PinholeCamera& lens = truth.intrinsics;
    camera.lens = {lens.fx, lens.cx, lens.cy};
    std::ranges::copy(lens.distortion, camera.lens.begin() + 3);
    return camera;
}

void time_solver() {
    fmt::print(
        "cameras,instants,seconds,held out px,centres mm,wand length mm,by the true cameras mm\n");
    for (const auto& [num_cameras, num_instants] :
         std::vector<std::pair<std::size_t, std::uint32_t>>{{8, 300}, {8, 1000}, {20, 5000}}) {
        SweepOptions options;
        options.num_cameras = num_cameras;
        options.num_instants = num_instants;
        const SweptRoom room = sweep(default_wand(), options);
        Expected<WandSolution> solution = WandSolution{};
        const double seconds = bench::seconds_of(
            [&] { solution = solve_wand(default_wand(), room.nominal, room.points, how()); });
        if (!solution) {
            fmt::print(stderr, "{}\n", solution.error().message);
            std::exit(1);
        }
        WandSolution truth = *solution;
        for (std::size_t c = 0; c < num_cameras; ++c)
            truth.bundle.cameras[c] = true_camera(room.cameras[c], truth.bundle.cameras[c]);
        measure_wand(truth);
        fmt::print("{},{},{:.1f},{:.3f},{:.2f},{:.2f},{:.2f}\n",
                   num_cameras,
                   num_instants,
                   seconds,
                   solution->held_out_px,
                   1000.0 * calibrate_test::centres_rms_m(room, *solution),
                   1000.0 * solution->wand_length_rms_m,
                   1000.0 * truth.wand_length_rms_m);
        std::fflush(stdout);
    }
}

}  // namespace

int main(int argc, char** argv) {
    const auto number = [&](int i, int otherwise) {
        return argc > i ? std::atoi(argv[i]) : otherwise;
    };
    if (argc >= 2 && std::strcmp(argv[1], "times") == 0) {
        time_solver();
    } else if (argc >= 2 && std::strcmp(argv[1], "trials") == 0) {
        bench::print_trials_heading();
        try_fault("none", nullptr, number(3, 50));
        for (const Fault& fault : faults()) try_fault(fault.name, fault.make, number(2, 20));
    } else {
        fmt::print(stderr, "usage: wand_trials trials [SEEDS [GOOD]] | wand_trials times\n");
        return 2;
    }
    return 0;
}
