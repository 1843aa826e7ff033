// Simulated calibrations with boards, and floors that boards and lights give, with and without
// faults: is each fault found and named, and is no good one refused?
//
//     board_trials [SEEDS [GOOD]]    CSV: fault, runs, refused, named, median seconds
//     board_trials widths [SEEDS]    CSV: how exact the cameras are with other robust widths
#include "bench/calibrate/fault_trials.hpp"
#include "core/base/median.hpp"
#include "tests/unit/calibrate/filmed_room.hpp"
#include "tests/unit/calibrate/lost_rig.hpp"
#include "tools/calibrate/board/judge_board.hpp"
#include "tools/calibrate/board/solve_board.hpp"
#include "tools/calibrate/floor/find_marks.hpp"
#include "tools/calibrate/floor/floor_frame.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace {

using namespace atrium;
using namespace atrium::calibrate;
using calibrate_test::FilmedRoom;
using calibrate_test::LostRig;
using calibrate_test::ShowOptions;

std::string quoted(std::size_t camera) { return fmt::format("'cam{}'", camera); }

// Boards that were shown to cameras.
struct Shown {
    Board board = calibrate_test::large_board();
    ShowOptions options;
    std::size_t camera = 0;  // that the fault is about
    std::function<void(FilmedRoom&)> spoil{};
    std::vector<std::string> expected{};  // one of these must be said
};

struct BoardFault {
    const char* name;
    std::function<void(Shown&, std::mt19937&)> make;
};

const std::vector<BoardFault>& board_faults() {
    static const std::vector<BoardFault> all{
        {"board: one picture late",
         [](Shown& shown, std::mt19937& rng) {
             const double late = rng() % 2 == 0 ? 1.0 : -1.0;
             shown.options.late_instants = late;
             shown.camera = shown.options.num_cameras - 1;
             shown.expected = {fmt::format(
                 "camera {} is {} by", quoted(shown.camera), late > 0.0 ? "late" : "early")};
         }},
        {"board: two cameras of one serial",
         [](Shown& shown, std::mt19937&) {
             const std::size_t other = (shown.camera + 1) % shown.options.num_cameras;
             shown.spoil = [a = shown.camera, other](FilmedRoom& room) {
                 room.points[other].corners = room.points[a].corners;
             };
             shown.expected = {"have the same pictures"};
         }},
        {"board: a camera that sees it alone",
         [](Shown& shown, std::mt19937&) {
             shown.spoil = [a = shown.camera](FilmedRoom& room) {
                 for (BoardCorner& corner : room.points[a].corners) corner.instant += 1000;
             };
             shown.expected = {
                 fmt::format("camera {} never shows the board together", quoted(shown.camera))};
         }},
        {"board: a camera with few pictures",
         [](Shown& shown, std::mt19937&) {
             shown.spoil = [a = shown.camera](FilmedRoom& room) {
                 std::erase_if(room.points[a].corners,
                               [](const BoardCorner& corner) { return corner.instant > 3; });
             };
             shown.expected = {fmt::format("camera {} shows the board", quoted(shown.camera)),
                               fmt::format("camera {} never shows", quoted(shown.camera))};
         }},
        {"board: never tilted",
         [](Shown& shown, std::mt19937&) {
             shown.options.num_cameras = 2;
             shown.options.ring = 0.03;
             shown.options.is_frontal = true;
             shown.options.noise_px = 0.4;
             shown.expected = {"Tilt the board by 30 to 60 degrees"};
         }},
        {"board: a camera of another recording",
         [](Shown& shown, std::mt19937&) {
             shown.spoil = [shown](FilmedRoom& room) {
                 ShowOptions other = shown.options;
                 other.seed += 1000;
                 room.points[shown.camera].corners =
                     calibrate_test::show({shown.board}, other).points[shown.camera].corners;
             };
             shown.expected = {fmt::format("camera {} contradicts", quoted(shown.camera))};
         }},
        {"board: pictures of one camera mirrored",
         [](Shown& shown, std::mt19937&) {
             shown.board.kind = BoardKind::kChessboard;
             shown.board.columns = 7;
             shown.board.rows = 6;
             shown.options.is_last_mirrored = true;
             shown.camera = shown.options.num_cameras - 1;
             shown.spoil = [a = shown.camera](FilmedRoom& room) {
                 // as the detector takes it, whose top left square is black
                 for (BoardCorner& corner : room.points[a].corners)
                     corner.corner = corner.corner / 6 * 6 + 5 - corner.corner % 6;
             };
             shown.expected = {
                 fmt::format("the pictures of camera {} are mirrored", quoted(shown.camera))};
         }},
    };
    return all;
}

std::vector<std::string> problems_of(const Shown& shown) {
    FilmedRoom room = calibrate_test::show({shown.board}, shown.options);
    if (shown.spoil) shown.spoil(room);
    if (const std::string twins = same_board_pictures(room.points); !twins.empty()) return {twins};
    BoardOptions how;
    how.num_threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    const auto solution = solve_board(room.boards, room.points, how);
    if (!solution) return {solution.error().message};
    return judge_board(*solution, 30.0).problems;
}

void try_board(const char* name,
               const std::function<void(Shown&, std::mt19937&)>& make,
               int seeds) {
    bench::print_trials(name, seeds, [&](std::uint32_t seed) {
        std::mt19937 rng(seed);
        Shown shown;
        shown.options.seed = seed;
        shown.options.num_cameras = 4 + rng() % 3;
        shown.options.num_instants = 120;
        shown.options.ring = 0.6;  // neighbours see the same side of the board
        shown.camera = rng() % shown.options.num_cameras;
        if (make) make(shown, rng);
        bench::Trial trial;
        trial.seconds = bench::seconds_of([&] { trial.problems = problems_of(shown); });
        trial.expected = shown.expected;
        return trial;
    });
}

// A board and lights that lie on the floor of a rig without a frame.
struct Lying {
    LostRig lost;
    Board board = calibrate_test::large_board();
    BoardPoints corners;
    std::vector<Eigen::Vector3d> lights_m{
        {0, 0, 0}, {0.8, 0, 0}, {0.1, 0.6, 0}, {-0.5, -0.4, 0}, {0.6, -0.5, 0}};
    bool has_lights = false;  // else the board
    std::size_t camera = 0;   // that the fault is about
    std::vector<std::string> expected{};
};

struct FloorFault {
    const char* name;
    std::function<void(Lying&, std::mt19937&)> make;
};

const std::vector<FloorFault>& floor_faults() {
    static const std::vector<FloorFault> all{
        {"floor: two lights exchanged: the room is mirrored",
         [](Lying& lying, std::mt19937&) {
             lying.has_lights = true;
             std::swap(lying.lights_m[1], lying.lights_m[2]);
             lying.expected = {"cameras would be below the floor"};
         }},
        {"floor: a camera that was moved since the calibration",
         [](Lying& lying, std::mt19937& rng) {
             const double angle = 0.001 * static_cast<double>(rng() % 6283);
             const Eigen::Vector2d off = 25.0 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
             for (BoardCorner& corner : lying.corners[lying.camera].corners) corner.px += off;
             lying.expected = {"the rig does not fit these pictures"};
         }},
        {"floor: the board was moved meanwhile",
         [](Lying& lying, std::mt19937&) {
             for (BoardCorner& corner : lying.corners[lying.camera].corners)
                 corner.px.x() += 9.0 * static_cast<double>(corner.instant);
             lying.expected = {
                 fmt::format("the board moves in the pictures of camera {}", quoted(lying.camera))};
         }},
        {"floor: lights on a line",
         [](Lying& lying, std::mt19937& rng) {
             lying.has_lights = true;
             const double slope = 0.1 * static_cast<double>(rng() % 20) - 1.0;
             for (std::size_t i = 0; i < lying.lights_m.size(); ++i)
                 lying.lights_m[i] = {
                     0.3 * static_cast<double>(i), 0.3 * static_cast<double>(i) * slope, 0.0};
             lying.expected = {"on a line"};
         }},
    };
    return all;
}

std::vector<std::string> problems_of(const Lying& lying) {
    Expected<FoundMarks> found = FoundMarks{};
    if (lying.has_lights) {
        std::mt19937 rng(static_cast<std::uint32_t>(lying.camera) + 1);
        std::normal_distribution<double> noise(0.0, 0.15);
        LightPoints points;
        for (const auto& camera : lying.lost.rig.cameras) {
            points.push_back({camera.name, {}});
            for (std::uint32_t i = 0; i < lying.lights_m.size(); ++i) {
                const Eigen::Vector2d px =
                    calibrate_test::seen_px(camera, lying.lost.rig_from_site * lying.lights_m[i]);
                points.back().points.push_back(
                    {0, i, px + Eigen::Vector2d(noise(rng), noise(rng))});
            }
        }
        found = marks_of_lights(lying.lost.rig, points, std::nullopt);
    } else {
        found = marks_of_board(lying.lost.rig, {lying.board}, lying.corners);
    }
    if (!found) return {found.error().message};
    if (!found->problems.empty()) return found->problems;
    const auto frame = floor_frame(found->marks, lying.lost.rig.cameras, {});
    if (!frame) return {frame.error().message};
    return {};
}

void try_floor(const char* name,
               const std::function<void(Lying&, std::mt19937&)>& make,
               int seeds) {
    bench::print_trials(name, seeds, [&](std::uint32_t seed) {
        std::mt19937 rng(seed);
        std::uniform_real_distribution<double> vary(-0.3, 0.3);
        Lying lying{.lost = calibrate_test::lost_rig(seed), .corners = {}};
        geometry::RigidTransform site_from_board;
        site_from_board.rotation = Eigen::AngleAxisd(10.0 * vary(rng), Eigen::Vector3d::UnitZ());
        site_from_board.translation = {vary(rng), vary(rng), 0.0};
        lying.corners = calibrate_test::lying(lying.lost, lying.board, site_from_board, seed);
        lying.camera = rng() % lying.lost.rig.cameras.size();
        if (make) make(lying, rng);
        bench::Trial trial;
        trial.seconds = bench::seconds_of([&] { trial.problems = problems_of(lying); });
        trial.expected = lying.expected;
        return trial;
    });
}

// RMS error of the cameras' places, and of their focal lengths.
struct Exactness {
    double centres_mm = 0.0;
    double focals_px = 0.0;
};

Exactness exactness_of(std::uint32_t seed, double jitter_instants, double robust_sigmas) {
    ShowOptions options;
    options.seed = seed;
    options.num_cameras = 4 + seed % 3;
    options.num_instants = 120;
    options.ring = 0.6;
    options.jitter_instants = jitter_instants;
    const FilmedRoom room = calibrate_test::show({calibrate_test::large_board()}, options);
    BoardOptions how;
    how.num_threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    how.robust_sigmas = robust_sigmas;
    how.outlier_sigmas = robust_sigmas + 2.0;
    const auto solution = solve_board(room.boards, room.points, how);
    if (!solution) return {std::nan(""), std::nan("")};
    std::vector<Eigen::Vector3d> centres;
    double squares = 0.0;
    for (std::size_t c = 0; c < room.cameras.size(); ++c) {
        const BundleCamera& found = solution->rig.bundle.cameras[c];
        centres.push_back(found.centre_world());
        squares += std::pow(found.intrinsics().fx - room.cameras[c].intrinsics.fx, 2);
    }
    return {1000.0 * calibrate_test::centres_off_m(room.cameras, centres),
            std::sqrt(squares / static_cast<double>(room.cameras.size()))};
}

void try_widths(int seeds) {
    fmt::print("jitter,robust sigmas,runs,failed,centres mm,focals px\n");
    // of the instant, at which the board moves by about 0.1 m
    for (const double jitter : {0.0, 0.01, 0.03, 0.1}) {
        for (const double sigmas : {1.5, 3.0, 5.0, 8.0, 12.0, 20.0}) {
            std::vector<double> centres_mm, focals_px;
            for (int seed = 1; seed <= seeds; ++seed) {
                const Exactness found =
                    exactness_of(static_cast<std::uint32_t>(seed), jitter, sigmas);
                if (std::isnan(found.centres_mm)) continue;
                centres_mm.push_back(found.centres_mm);
                focals_px.push_back(found.focals_px);
            }
            const auto num_failed = static_cast<std::size_t>(seeds) - centres_mm.size();
            fmt::print("{},{},{},{},{:.2f},{:.2f}\n",
                       jitter,
                       sigmas,
                       seeds,
                       num_failed,
                       median_of(std::move(centres_mm)),
                       median_of(std::move(focals_px)));
            std::fflush(stdout);
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    const auto number = [&](int i, int otherwise) {
        return argc > i ? std::atoi(argv[i]) : otherwise;
    };
    if (argc > 1 && std::string(argv[1]) == "widths") {
        try_widths(number(2, 20));
        return 0;
    }
    bench::print_trials_heading();
    try_board("board: none", nullptr, number(2, 50));
    for (const BoardFault& fault : board_faults()) try_board(fault.name, fault.make, number(1, 20));
    try_floor("floor: none", nullptr, number(2, 50));
    for (const FloorFault& fault : floor_faults()) try_floor(fault.name, fault.make, number(1, 20));
    return 0;
}
