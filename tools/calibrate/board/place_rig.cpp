#include "tools/calibrate/board/place_rig.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

namespace atrium::calibrate {
namespace {

constexpr std::size_t kMostTried = 40;
constexpr double kAgrees = 0.012;  // of a picture's width: median error of a view
constexpr double kOther_rad = 8.0 * std::numbers::pi / 180.0;
constexpr int kMostLate = 5;
constexpr std::size_t kAgreeingLate = 6;  // fewer may be chance, of ten tries

double turn_between(const geometry::RigidTransform& a, const geometry::RigidTransform& b) {
    return a.rotation.angularDistance(b.rotation);
}

struct SharedBoard {
    const BoardView* in_a;
    const BoardView* in_b;
};

double agreement(const Bundle& bundle,
                 const SharedBoard& board,
                 const geometry::RigidTransform& b_from_a,
                 const geometry::RigidTransform& a_from_b) {
    double least = std::numeric_limits<double>::max();
    for (const BoardPlace& place : board.in_a->places) {
        const double error =
            error_of_place(bundle, *board.in_b, b_from_a * place.camera_from_board) /
            bundle.cameras[board.in_b->camera].width;
        // both ways: a board far from one camera tells little there
        double back = std::numeric_limits<double>::max();
        for (const BoardPlace& other : board.in_b->places)
            back =
                std::min(back,
                         error_of_place(bundle, *board.in_a, a_from_b * other.camera_from_board) /
                             bundle.cameras[board.in_a->camera].width);
        least = std::min(least, std::max(error, back));
    }
    return least;
}

struct Hypothesis {
    geometry::RigidTransform b_from_a;
    std::size_t num_agreeing = 0;
    double error = 0.0;

    bool operator<(const Hypothesis& other) const {
        return num_agreeing != other.num_agreeing ? num_agreeing < other.num_agreeing
                                                  : error > other.error;
    }
};

CameraPair solve_pair(const Bundle& bundle, const std::vector<SharedBoard>& shared) {
    CameraPair pair;
    pair.a = shared.front().in_a->camera;
    pair.b = shared.front().in_b->camera;
    pair.num_shared = shared.size();
    pair.num_tried = std::min(shared.size(), kMostTried);
    std::vector<SharedBoard> tried;
    for (std::size_t i = 0; i < pair.num_tried; ++i)
        tried.push_back(shared[i * shared.size() / pair.num_tried]);
    std::vector<Hypothesis> all;
    for (const SharedBoard& board : tried) {
        for (const BoardPlace& in_a : board.in_a->places) {
            for (const BoardPlace& in_b : board.in_b->places) {
                Hypothesis one;
                one.b_from_a = in_b.camera_from_board * in_a.camera_from_board.inverse();
                const geometry::RigidTransform a_from_b = one.b_from_a.inverse();
                for (const SharedBoard& other : tried) {
                    const double error = agreement(bundle, other, one.b_from_a, a_from_b);
                    if (error > kAgrees) continue;
                    ++one.num_agreeing;
                    one.error += error;
                }
                all.push_back(one);
            }
        }
    }
    const auto best = std::ranges::max_element(all, std::less<>());
    if (best == all.end()) return pair;
    pair.b_from_a = best->b_from_a;
    pair.num_agreeing = best->num_agreeing;
    Hypothesis rival;
    for (const Hypothesis& one : all)
        if (turn_between(one.b_from_a, best->b_from_a) > kOther_rad && rival < one) rival = one;
    pair.rival_b_from_a = rival.b_from_a;
    pair.num_rival = rival.num_agreeing;
    return pair;
}

// Places the board of views of one pose where all of them agree best.
void place_board(Bundle& bundle, std::span<const BoardView> views) {
    WandPose& board = bundle.wands[views.front().pose];
    board.is_placed = false;
    double least = std::numeric_limits<double>::max();
    for (const BoardView& view : views) {
        if (!bundle.cameras[view.camera].is_placed) continue;
        const auto world_from_camera = bundle.cameras[view.camera].camera_from_world().inverse();
        for (const BoardPlace& place : view.places) {
            const geometry::RigidTransform world_from_board =
                world_from_camera * place.camera_from_board;
            double cost = 1e-6 * place.rms_px;  // of views that say nothing else
            for (const BoardView& other : views) {
                const BundleCamera& camera = bundle.cameras[other.camera];
                if (!camera.is_placed) continue;
                const double error =
                    error_of_place(bundle, other, camera.camera_from_world() * world_from_board) /
                    (kAgrees * camera.width);
                cost += std::log1p(std::min(error, 1e6) * std::min(error, 1e6));
            }
            if (cost >= least) continue;
            least = cost;
            board.world_from_wand = world_from_board;
            board.is_placed = true;
        }
    }
}

}  // namespace

std::vector<CameraPair> pairs_of(const Bundle& bundle,
                                 const std::vector<BoardView>& views,
                                 std::optional<std::size_t> only) {
    const std::size_t n = bundle.cameras.size();
    std::vector<std::vector<SharedBoard>> shared(n * n);
    for (std::size_t i = 0; i < views.size(); ++i) {
        for (std::size_t j = i + 1; j < views.size() && views[j].pose == views[i].pose; ++j) {
            if (views[i].places.empty() || views[j].places.empty()) continue;
            if (only && views[i].camera != *only && views[j].camera != *only) continue;
            shared[views[i].camera * n + views[j].camera].push_back({&views[i], &views[j]});
        }
    }
    std::vector<CameraPair> pairs;
    for (const auto& boards : shared)
        if (!boards.empty()) pairs.push_back(solve_pair(bundle, boards));
    return pairs;
}

std::vector<std::size_t> place_rig(Bundle& bundle,
                                   const std::vector<BoardView>& views,
                                   const std::vector<CameraPair>& pairs,
                                   std::optional<std::size_t> rival) {
    std::vector<double> worth(bundle.cameras.size(), 0.0);
    const auto weight = [](const CameraPair& pair) {
        return static_cast<double>(pair.num_agreeing) - 0.5 * static_cast<double>(pair.num_rival);
    };
    for (const CameraPair& pair : pairs) {
        if (!pair.is_usable()) continue;
        worth[pair.a] += weight(pair);
        worth[pair.b] += weight(pair);
    }
    for (BundleCamera& camera : bundle.cameras) camera.is_placed = false;
    const auto first = static_cast<std::size_t>(std::ranges::max_element(worth) - worth.begin());
    bundle.cameras[first].is_placed = true;
    bundle.cameras[first].set_camera_from_world({});
    std::vector<std::size_t> used;
    for (;;) {
        std::optional<std::size_t> best;
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            const CameraPair& pair = pairs[i];
            if (!pair.is_usable() ||
                bundle.cameras[pair.a].is_placed == bundle.cameras[pair.b].is_placed)
                continue;
            if (!best || weight(pair) > weight(pairs[*best])) best = i;
        }
        if (!best) break;
        const CameraPair& pair = pairs[*best];
        const auto& b_from_a = rival == best ? pair.rival_b_from_a : pair.b_from_a;
        BundleCamera& a = bundle.cameras[pair.a];
        BundleCamera& b = bundle.cameras[pair.b];
        if (a.is_placed)
            b.set_camera_from_world(b_from_a * a.camera_from_world());
        else
            a.set_camera_from_world(b_from_a.inverse() * b.camera_from_world());
        a.is_placed = b.is_placed = true;
        used.push_back(*best);
    }
    for (std::size_t begin = 0; begin < views.size();) {
        std::size_t end = begin;
        while (end < views.size() && views[end].pose == views[begin].pose) ++end;
        place_board(bundle, std::span(views).subspan(begin, end - begin));
        begin = end;
    }
    return used;
}

int find_lateness(const Bundle& bundle,
                  const std::vector<BoardView>& views,
                  std::size_t camera,
                  const std::vector<std::uint32_t>& instants) {
    int found = 0;
    std::size_t most = 0;
    for (int late = -kMostLate; late <= kMostLate; ++late) {
        if (late == 0) continue;
        std::vector<BoardView> moved;
        for (BoardView view : views) {
            if (view.camera == camera) {
                const std::int64_t pose = static_cast<std::int64_t>(view.pose) - late;
                if (pose < 0 || pose >= static_cast<std::int64_t>(instants.size())) continue;
                const auto index = static_cast<std::size_t>(pose);
                if (static_cast<std::int64_t>(instants[index]) !=
                    static_cast<std::int64_t>(instants[view.pose]) - late)
                    continue;
                view.pose = static_cast<std::uint32_t>(pose);
            }
            moved.push_back(std::move(view));
        }
        std::ranges::stable_sort(moved, [](const BoardView& a, const BoardView& b) {
            return a.pose != b.pose ? a.pose < b.pose : a.camera < b.camera;
        });
        std::size_t num = 0;
        for (const CameraPair& pair : pairs_of(bundle, moved, camera))
            if (pair.num_agreeing >= kAgreeingLate && 4 * pair.num_agreeing >= 3 * pair.num_tried)
                num += pair.num_agreeing;
        if (num <= most) continue;
        most = num;
        found = late;
    }
    return found;
}

}  // namespace atrium::calibrate
