#include "tools/calibrate/board/solve_board.hpp"

#include "core/base/median.hpp"
#include "tools/calibrate/adjust/place_wands.hpp"
#include "tools/calibrate/board/start_lens.hpp"
#include "tools/calibrate/board/unplaced.hpp"
#include "tools/calibrate/wand/lateness.hpp"
#include "tools/calibrate/wand/measure_wand.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>

namespace atrium::calibrate {
namespace {

constexpr double kBoardLeastOutlier_px = 1.0;
constexpr double kFirstRobust_px = 4.0;
constexpr int kFirstIterations = 20;
constexpr std::uint32_t kInstantsHeldOutOf = 5;
constexpr std::size_t kMostRivals = 8;
constexpr double kSameTurn_deg = 5.0;
constexpr double kAsGood = 1.3, kAsGood_px = 0.05;  // of the median error of a rival
constexpr double kDoubtfulLateInstants = 0.1;
constexpr std::size_t kDoubtfulOutliers = 4;  // an outlier for so many corners that fit

double median_error_px(const Bundle& bundle) {
    std::vector<double> errors;
    for (const Sighting& sighting : bundle.sightings) {
        const double error = error_px(bundle, sighting).norm();
        if (bundle.cameras[sighting.camera].is_placed)
            errors.push_back(std::isfinite(error) ? error : 1e6);
    }
    return median_of(std::move(errors));
}

class BoardSolver {
public:
    BoardSolver(const std::vector<Board>& boards,
                const BoardPoints& points,
                const BoardOptions& options)
        : options_(options) {
        BoardBundle made = bundle_of(boards, points);
        solution_.rig.bundle = std::move(made.bundle);
        solution_.rig.instants = std::move(made.instants);
        solution_.rig.cameras.resize(points.size());
        for (std::size_t c = 0; c < points.size(); ++c)
            solution_.rig.cameras[c].num_points = points[c].corners.size();
        views_ = views_of(solution_.rig.bundle);
    }

    Expected<BoardSolution> solve() {
        Bundle& bundle = solution_.rig.bundle;
        if (const auto done = start_lenses(); !done) return tl::unexpected(done.error());
        report("placing the cameras");
        nominal_ = bundle.cameras;
        for (const BundleCamera& camera : nominal_)
            solution_.own_focals_px.push_back(camera.lens[0]);
        for (BoardView& view : views_) view.places = find_places(bundle, view);
        solution_.pairs = pairs_of(bundle, views_);
        const auto used = place_rig(bundle, views_, solution_.pairs);
        if (const std::string unplaced =
                explain_unplaced(bundle, views_, solution_.pairs, solution_.rig.instants);
            !unplaced.empty())
            return make_error(ErrorKind::kInvalidData, unplaced);
        if (const auto done = settle(bundle); !done) return tl::unexpected(done.error());
        try_rivals(used);
        report("adjusting all cameras");
        mark_outliers(bundle);
        for (int round = 0; round < 2; ++round) {
            if (const auto done = adjust_all(bundle, false); !done)
                return tl::unexpected(done.error());
            mark_outliers(bundle);
        }
        report("checking with a fifth of the instants");
        if (const auto done = hold_out(); !done) return tl::unexpected(done.error());
        measure_wand(solution_.rig);
        measure_views();
        solution_.sigma_px = sigma_;
        solution_.uncertainties = uncertainty_of(bundle, options_.lens, sigma_);
        search_lateness();
        return std::move(solution_);
    }

private:
    void report(const std::string& text) const {
        if (options_.report) options_.report(text);
    }

    Expected<void> start_lenses() {
        Bundle& bundle = solution_.rig.bundle;
        std::string problems;
        for (std::size_t c = 0; c < bundle.cameras.size(); ++c) {
            report(fmt::format("lens of camera '{}'", bundle.cameras[c].name));
            const auto rms = start_lens(bundle, c, views_, options_.lens, options_.num_threads);
            if (rms) continue;
            problems += (problems.empty() ? "" : "; ") + rms.error().message;
        }
        if (!problems.empty()) return make_error(ErrorKind::kInvalidData, problems);
        return {};
    }

    // With the lenses of the start.
    Expected<void> settle(Bundle& bundle) const {
        AdjustOptions adjustment;
        adjustment.lens = LensFreedom::kFixed;
        adjustment.robust_px = kFirstRobust_px;
        adjustment.max_iterations = kFirstIterations;
        adjustment.num_threads = options_.num_threads;
        return adjust(bundle, adjustment);
    }

    // Another place of a camera that the boards explain about as well.
    void try_rivals(const std::vector<std::size_t>& used) {
        std::size_t num_tried = 0;
        const Bundle base = solution_.rig.bundle;
        double base_px = median_error_px(base);
        for (const std::size_t index : used) {
            const CameraPair& pair = solution_.pairs[index];
            if (!pair.is_ambiguous() || ++num_tried > kMostRivals) continue;
            Bundle tried = base;
            place_rig(tried, views_, solution_.pairs, index);
            if (!settle(tried)) continue;
            const auto b_from_a = [&](const Bundle& bundle) {
                return bundle.cameras[pair.b].camera_from_world() *
                       bundle.cameras[pair.a].camera_from_world().inverse();
            };
            const double turn_deg =
                b_from_a(tried).rotation.angularDistance(b_from_a(base).rotation) * 180.0 /
                std::numbers::pi;
            if (turn_deg < kSameTurn_deg) continue;
            const double px = median_error_px(tried);
            if (px < kAsGood * base_px + kAsGood_px && base_px < kAsGood * px + kAsGood_px)
                solution_.ambiguities.push_back({pair.a, pair.b, turn_deg, base_px, px});
            if (px >= median_error_px(solution_.rig.bundle)) continue;
            solution_.rig.bundle = std::move(tried);
        }
    }

    Expected<void> adjust_all(Bundle& bundle, bool are_cameras_fixed) const {
        AdjustOptions adjustment;
        adjustment.lens = options_.lens;
        adjustment.robust_px = options_.robust_sigmas * std::max(sigma_, 0.05);
        adjustment.num_threads = options_.num_threads;
        adjustment.are_cameras_fixed = are_cameras_fixed;
        return adjust(bundle, adjustment);
    }

    void mark_outliers(Bundle& bundle) {
        std::vector<double> errors;
        for (const Sighting& sighting : bundle.sightings) {
            const Eigen::Vector2d error = error_px(bundle, sighting);
            if (error.allFinite())
                errors.insert(errors.end(), {std::abs(error.x()), std::abs(error.y())});
        }
        sigma_ = 1.4826 * median_of(std::move(errors));
        const double most_px = std::max(kBoardLeastOutlier_px, options_.outlier_sigmas * sigma_);
        for (Sighting& sighting : bundle.sightings)
            sighting.is_used = error_px(bundle, sighting).norm() <= most_px;  // false for NaN
    }

    // Instants that several cameras saw.
    std::vector<std::uint32_t> shared_instants() const {
        const Bundle& bundle = solution_.rig.bundle;
        std::map<std::uint32_t, std::set<std::uint32_t>> cameras;
        for (const Sighting& sighting : bundle.sightings)
            if (sighting.is_used)
                cameras[solution_.rig.instants[sighting.instant]].insert(sighting.camera);
        std::vector<std::uint32_t> instants;
        for (const auto& [instant, seen_by] : cameras)
            if (seen_by.size() > 1) instants.push_back(instant);
        return instants;
    }

    Expected<void> hold_out() {
        std::mt19937 choose(1);
        std::set<std::uint32_t> held_out;
        for (const std::uint32_t instant : shared_instants())
            if (choose() % kInstantsHeldOutOf == 0) held_out.insert(instant);
        Bundle part = solution_.rig.bundle;
        const auto is_held_out = [&](const Sighting& sighting) {
            return held_out.contains(solution_.rig.instants[sighting.instant]);
        };
        for (Sighting& sighting : part.sightings)
            if (is_held_out(sighting)) sighting.is_used = false;
        if (const auto done = adjust_all(part, false); !done) return done;
        for (std::size_t i = 0; i < part.sightings.size(); ++i)
            part.sightings[i].is_used =
                is_held_out(part.sightings[i]) && solution_.rig.bundle.sightings[i].is_used;
        if (!held_out.empty())
            if (const auto done = adjust_all(part, true); !done) return done;
        std::vector<double> sums(part.cameras.size(), 0.0), counts(part.cameras.size(), 0.0);
        double sum = 0.0, count = 0.0;
        for (const Sighting& sighting : part.sightings) {
            if (!sighting.is_used) continue;
            const double squared = error_px(part, sighting).squaredNorm();
            if (!std::isfinite(squared)) continue;
            sums[sighting.camera] += squared;
            counts[sighting.camera] += 2.0;
            sum += squared;
            count += 2.0;
        }
        for (std::size_t c = 0; c < sums.size(); ++c)
            solution_.rig.cameras[c].held_out_px = std::sqrt(sums[c] / std::max(counts[c], 1.0));
        solution_.rig.held_out_px = std::sqrt(sum / std::max(1.0, count));
        return {};
    }

    void measure_views() {
        const Bundle& bundle = solution_.rig.bundle;
        solution_.num_views.assign(bundle.cameras.size(), 0);
        solution_.num_shared.assign(bundle.cameras.size(), 0);
        std::map<std::uint32_t, std::set<std::uint32_t>> cameras;  // by pose
        for (const Sighting& sighting : bundle.sightings)
            if (sighting.is_used) cameras[sighting.instant].insert(sighting.camera);
        std::set<std::uint32_t> instants;
        for (const auto& [pose, seen_by] : cameras) {
            for (const std::uint32_t camera : seen_by) {
                ++solution_.num_views[camera];
                if (seen_by.size() > 1) ++solution_.num_shared[camera];
            }
            if (seen_by.size() > 1) instants.insert(solution_.rig.instants[pose]);
        }
        solution_.rig.num_instants = instants.size();
    }

    // Of the few cameras that contradict the others.
    void search_lateness() {
        WandSolution& rig = solution_.rig;
        std::vector<std::size_t> doubtful;
        for (std::size_t c = 0; c < rig.cameras.size(); ++c)
            if (std::abs(rig.cameras[c].late_instants) > kDoubtfulLateInstants ||
                rig.cameras[c].num_outliers > rig.cameras[c].num_used / kDoubtfulOutliers)
                doubtful.push_back(c);
        if (3 * doubtful.size() > rig.cameras.size()) return;
        for (const std::size_t c : doubtful) {
            report(fmt::format("looking whether camera '{}' is late", nominal_[c].name));
            rig.cameras[c].late_instants =
                large_lateness(rig, c, nominal_[c], options_.num_threads);
        }
    }

    const BoardOptions& options_;
    BoardSolution solution_;
    std::vector<BoardView> views_;
    std::vector<BundleCamera> nominal_;  // with the lenses of the start
    double sigma_ = 1.0;                 // [px] of the noise of a coordinate
};

}  // namespace

BoardBundle bundle_of(const std::vector<Board>& boards, const BoardPoints& points) {
    BoardBundle made;
    std::vector<std::uint32_t> board_of;
    for (std::size_t b = 0; b < boards.size(); ++b) {
        for (std::size_t corner = 0; corner < boards[b].num_corners(); ++corner) {
            made.bundle.wand.lights_m.push_back(boards[b].corner_m(corner));
            board_of.push_back(static_cast<std::uint32_t>(b));
        }
    }
    std::set<std::uint32_t> all;
    for (const BoardCamera& camera : points) {
        BundleCamera bundled;
        bundled.name = camera.name;
        bundled.width = camera.width;
        bundled.height = camera.height;
        made.bundle.cameras.push_back(bundled);
        for (const BoardCorner& corner : camera.corners) all.insert(corner.instant);
    }
    const std::vector<std::uint32_t> instants(all.begin(), all.end());
    for (std::size_t b = 0; b < boards.size(); ++b)
        made.instants.insert(made.instants.end(), instants.begin(), instants.end());
    made.bundle.wands.resize(made.instants.size());
    for (std::size_t c = 0; c < points.size(); ++c) {
        for (const BoardCorner& corner : points[c].corners) {
            const auto index = static_cast<std::size_t>(
                std::ranges::lower_bound(instants, corner.instant) - instants.begin());
            made.bundle.sightings.push_back(
                {static_cast<std::uint32_t>(c),
                 static_cast<std::uint32_t>(board_of[corner.corner] * instants.size() + index),
                 corner.corner,
                 corner.px,
                 true});
        }
    }
    std::ranges::stable_sort(made.bundle.sightings, [](const Sighting& a, const Sighting& b) {
        return a.instant != b.instant ? a.instant < b.instant : a.camera < b.camera;
    });
    return made;
}

Expected<BoardSolution> solve_board(const std::vector<Board>& boards,
                                    const BoardPoints& points,
                                    const BoardOptions& options) {
    return BoardSolver(boards, points, options).solve();
}

}  // namespace atrium::calibrate
