#include "core/base/median.hpp"
#include "tools/calibrate/adjust/place_wands.hpp"
#include "tools/calibrate/board/place_rig.hpp"
#include "tools/calibrate/board/solve_board.hpp"
#include "tools/calibrate/floor/find_marks.hpp"
#include "tools/calibrate/floor/rig_bundle.hpp"
#include "tools/calibrate/recording/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace atrium::calibrate {
namespace {

constexpr double kMoves_px = 2.0;     // of a corner, between pictures
constexpr double kFitsRig_px = 3.0;   // median error
constexpr double kRivalOfBest = 1.5;  // its median error is no more: a second place
constexpr double kScaleOff = 0.01;
constexpr double kScaleWrong = 0.05;

class LyingBoard {
public:
    LyingBoard(const config::Rig& rig, const Board& board) : rig_(rig), board_(board) {
        bundle_.cameras = ideal_cameras(rig);
        for (std::size_t i = 0; i < board.num_corners(); ++i)
            bundle_.wand.lights_m.push_back(board.corner_m(i));
        bundle_.wands.resize(1);
    }

    Expected<FoundMarks> find(const BoardPoints& points) {
        if (const auto done = take(points); !done) return tl::unexpected(done.error());
        if (const auto done = place(); !done) return tl::unexpected(done.error());
        const geometry::RigidTransform& rig_from_board = bundle_.wands[0].world_from_wand;
        FoundMarks found;
        FloorMarks& marks = found.marks;
        marks.origin = rig_from_board.translation;
        marks.on_x = rig_from_board * Eigen::Vector3d(board_.columns * board_.square_m, 0, 0);
        marks.on_y_side = rig_from_board * Eigen::Vector3d(0, board_.rows * board_.square_m, 0);
        for (const Eigen::Vector3d& corner : bundle_.wand.lights_m)
            marks.on_floor.push_back(rig_from_board * corner);
        check_scale(found);
        found.told.push_back(fmt::format(
            "board: seen by {}, {:.2f} px off where the rig says", listed(seen_by_), median_px_));
        return found;
    }

private:
    // The mean of each corner: the board lies still.
    Expected<void> take(const BoardPoints& points) {
        for (const BoardCamera& camera : points) {
            const auto index = camera_index(rig_, camera.name);
            if (!index) return tl::unexpected(index.error());
            const geometry::PinholeCamera& lens = rig_.cameras[*index].intrinsics;
            if (!camera.corners.empty() &&
                (camera.width != lens.width || camera.height != lens.height))
                return make_error(ErrorKind::kConfiguration,
                                  fmt::format("camera '{}': the rig is of {}x{} px, the pictures "
                                              "are of {}x{} px: take pictures of the rig's size",
                                              camera.name,
                                              lens.width,
                                              lens.height,
                                              camera.width,
                                              camera.height));
            std::map<std::uint32_t, std::vector<Eigen::Vector2d>> seen;
            for (const BoardCorner& corner : camera.corners)
                if (corner.corner < board_.num_corners()) seen[corner.corner].push_back(corner.px);
            std::vector<double> moved;
            for (const auto& [corner, places] : seen) {
                std::vector<double> xs, ys;
                for (const Eigen::Vector2d& px : places) {
                    xs.push_back(px.x());
                    ys.push_back(px.y());
                }
                const Eigen::Vector2d middle(median_of(xs), median_of(ys));
                for (const Eigen::Vector2d& px : places) moved.push_back((px - middle).norm());
                if (const auto px = undistorted(lens, middle))
                    bundle_.sightings.push_back(
                        {static_cast<std::uint32_t>(*index), 0, corner, *px, true});
            }
            if (!moved.empty()) {
                std::ranges::sort(moved);
                if (moved[moved.size() * 9 / 10] > kMoves_px)
                    return make_error(
                        ErrorKind::kInvalidData,
                        fmt::format("the board moves in the pictures of camera '{}', by {:.0f} px "
                                    "and more: give pictures in which it lies still on the floor",
                                    camera.name,
                                    moved[moved.size() * 9 / 10]));
                seen_by_.push_back(camera.name);
            }
        }
        std::ranges::stable_sort(bundle_.sightings, {}, &Sighting::camera);
        if (bundle_.sightings.empty())
            return make_error(
                ErrorKind::kInvalidData,
                "no camera of the rig shows the board: lay it where the cameras look, "
                "with its face up");
        return {};
    }

    double median_error(const geometry::RigidTransform& rig_from_board) const {
        std::vector<double> errors;
        for (const BoardView& view : views_)
            errors.push_back(error_of_place(
                bundle_, view, bundle_.cameras[view.camera].camera_from_world() * rig_from_board));
        return errors.empty() ? 1e9 : *std::ranges::max_element(errors);
    }

    Expected<void> place() {
        views_ = views_of(bundle_);
        // each place that any camera thinks possible, then the one that all agree on
        std::vector<geometry::RigidTransform> candidates;
        for (BoardView& view : views_) {
            view.places = find_places(bundle_, view);
            for (const BoardPlace& at : view.places)
                candidates.push_back(bundle_.cameras[view.camera].camera_from_world().inverse() *
                                     at.camera_from_board);
        }
        double best_px = 1e9, rival_px = 1e9;
        geometry::RigidTransform best;
        std::vector<std::pair<double, geometry::RigidTransform>> settled;
        for (const geometry::RigidTransform& candidate : candidates) {
            bundle_.wands[0] = {candidate, true};
            AdjustOptions adjustment;
            adjustment.lens = LensFreedom::kFixed;
            adjustment.robust_px = kFitsRig_px;
            adjustment.are_cameras_fixed = true;
            if (!adjust(bundle_, adjustment)) continue;
            const auto& pose = bundle_.wands[0].world_from_wand;
            settled.emplace_back(median_error(pose), pose);
            if (settled.back().first >= best_px) continue;
            best_px = settled.back().first;
            best = pose;
        }
        if (best_px > kFitsRig_px)
            return make_error(
                ErrorKind::kInvalidData,
                fmt::format("the rig does not fit these pictures: the board is {:.0f} px off where "
                            "its cameras would see it. Did a camera move since the calibration, "
                            "and is --board this board?",
                            std::min(best_px, 9999.0)));
        constexpr double kOtherWay_rad = 0.14;
        for (const auto& [px, pose] : settled)
            if (pose.rotation.angularDistance(best.rotation) > kOtherWay_rad)
                rival_px = std::min(rival_px, px);
        if (rival_px < kRivalOfBest * best_px + 0.1)
            return make_error(
                ErrorKind::kInvalidData,
                fmt::format("the board may lie in two ways, which explain its pictures in {} about "
                            "as well ({:.2f} and {:.2f} px): lay it nearer, or where two cameras "
                            "see it from different sides",
                            listed(seen_by_),
                            best_px,
                            rival_px));
        bundle_.wands[0] = {best, true};
        median_px_ = best_px;
        return {};
    }

    // Corners as the cameras alone see them, beside the board.
    void check_scale(FoundMarks& found) const {
        std::vector<Eigen::Vector3d> seen, known;
        for (std::uint32_t corner = 0; corner < board_.num_corners(); ++corner) {
            std::vector<const Sighting*> sightings;
            for (const Sighting& sighting : bundle_.sightings)
                if (sighting.light == corner) sightings.push_back(&sighting);
            if (const auto at = triangulate(bundle_, sightings)) {
                seen.push_back(*at);
                known.push_back(bundle_.wand.lights_m[corner]);
            }
        }
        if (seen.size() < 4) {
            found.checks.push_back(
                fmt::format("only {} sees the board well enough: a second "
                            "camera would prove that it lies as it seems",
                            listed(seen_by_)));
            return;
        }
        const auto spread = [](const std::vector<Eigen::Vector3d>& points) {
            Eigen::Vector3d middle = Eigen::Vector3d::Zero();
            for (const Eigen::Vector3d& p : points)
                middle += p / static_cast<double>(points.size());
            double sum = 0.0;
            for (const Eigen::Vector3d& p : points) sum += (p - middle).squaredNorm();
            return std::sqrt(sum);
        };
        const double ratio = spread(seen) / spread(known);
        if (std::abs(ratio - 1.0) < kScaleOff) return;
        const std::string text = fmt::format(
            "the rig sees the board {:.1f} % {} than --board says: square_m, or the scale of the "
            "rig, is wrong",
            100.0 * std::abs(ratio - 1.0),
            ratio > 1.0 ? "larger" : "smaller");
        (std::abs(ratio - 1.0) < kScaleWrong ? found.checks : found.problems).push_back(text);
    }

    const config::Rig& rig_;
    const Board& board_;
    Bundle bundle_;
    std::vector<BoardView> views_;
    std::vector<std::string> seen_by_;
    double median_px_ = 0.0;
};

}  // namespace

Expected<FoundMarks> marks_of_board(const config::Rig& rig,
                                    const std::vector<Board>& boards,
                                    const BoardPoints& points) {
    return LyingBoard(rig, boards.front()).find(points);
}

}  // namespace atrium::calibrate
