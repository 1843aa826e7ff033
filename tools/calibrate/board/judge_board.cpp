#include "tools/calibrate/board/judge_board.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace atrium::calibrate {
namespace {

constexpr double kUsableBoard_px = 1.5;      // cameras without a trigger see the board's motion
constexpr double kManyBoardOutliers = 0.25;  // of one camera
constexpr double kSomeOutliersOfAll = 0.02,
                 kManyOutliersOfAll = 0.05;  // of all: no single one is to blame
constexpr double kSmallBoardCoverage = 0.3;
constexpr double kLateBoard = 0.25;  // instants
constexpr std::size_t kFewViews = 15, kTooFewViews = 5;
constexpr std::size_t kFewSharedViews = 8;
// Standard deviations of f that a good lens does not have.
constexpr double kOpenFocal = 0.01, kVagueFocal = 0.004;
constexpr double kOtherFocal = 0.04;  // of f from the camera's own pictures

class BoardJudge {
public:
    BoardJudge(const BoardSolution& solution, double rate_hz)
        : solution_(solution), rig_(solution.rig), rate_hz_(rate_hz) {}

    Verdict run() {
        for (const Ambiguity& ambiguity : solution_.ambiguities) judge(ambiguity);
        for (std::size_t c = 0; c < rig_.cameras.size(); ++c) judge_camera(c);
        judge_outliers();
        if (rig_.held_out_px > kUsableBoard_px)
            verdict_.problems.push_back(
                fmt::format("errors of {:.2f} px are no calibration: is the board flat, and did "
                            "all cameras take their pictures at the same time? Hold it still at "
                            "each place if they have no trigger",
                            rig_.held_out_px));
        else if (rig_.held_out_px > kGood_px)
            verdict_.checks.push_back(
                fmt::format("errors of {:.2f} px: hold the board still at each place, in light in "
                            "which it is not blurred; cameras without a trigger see it at other "
                            "times",
                            rig_.held_out_px));
        verdict_.told.insert(
            verdict_.told.begin(),
            fmt::format("{}: {:.2f} px RMS of boards that the solution did not use, {:.2f} px of "
                        "the others; {} cameras, {} instants in which two or more saw a board",
                        !verdict_.problems.empty() ? "wrong"
                        : rig_.held_out_px <= kGood_px && share_of_outliers() <= kSomeOutliersOfAll
                            ? "good"
                            : "usable",
                        rig_.held_out_px,
                        rig_.rms_px,
                        rig_.cameras.size(),
                        rig_.num_instants));
        return std::move(verdict_);
    }

private:
    const std::string& name(std::size_t c) const { return rig_.bundle.cameras[c].name; }

    // Of the corners of all cameras.
    double share_of_outliers() const {
        std::size_t num_outliers = 0, num_all = 0;
        for (const CameraFigures& figures : rig_.cameras) {
            num_outliers += figures.num_outliers;
            num_all += figures.num_outliers + figures.num_used;
        }
        return static_cast<double>(num_outliers) /
               static_cast<double>(std::max<std::size_t>(num_all, 1));
    }

    // Outliers do not count as errors, but what made them bends the cameras as well.
    void judge_outliers() {
        const double share = share_of_outliers();
        if (share <= kSomeOutliersOfAll || !verdict_.problems.empty()) return;
        (share > kManyOutliersOfAll ? verdict_.problems : verdict_.checks)
            .push_back(fmt::format(
                "{:.0f} % of all corners contradict the others, so the cameras may be centimetres "
                "off: the board moved between the pictures of an instant, because the cameras have "
                "no common trigger, or this computer is too slow for them: hold the board still at "
                "each place, or take fewer pictures per second",
                100.0 * share));
    }

    void judge(const Ambiguity& ambiguity) {
        verdict_.problems.push_back(fmt::format(
            "the places of '{}' and '{}' are not sure: turned by {:.0f} degrees against "
            "each other they explain the boards about as well ({:.2f} and {:.2f} px): "
            "the board was small in their pictures, or always leaned the same way. "
            "Show it to both, nearer and tilted to all sides",
            name(ambiguity.a),
            name(ambiguity.b),
            ambiguity.turn_deg,
            ambiguity.median_px,
            ambiguity.rival_px));
    }

    void judge_camera(std::size_t c) {
        const CameraFigures& figures = rig_.cameras[c];
        const CameraUncertainty& open = solution_.uncertainties[c];
        const double focal = rig_.bundle.cameras[c].lens[0];
        verdict_.told.push_back(fmt::format(
            "camera '{}': {:.2f} px, {:.2f} mm at the boards; {} corners in {} pictures, {} "
            "outliers; corners in {:.0f} % of the picture; f {:.1f} px, known to {:.1f} px",
            name(c),
            figures.held_out_px,
            figures.middle_mm,
            figures.num_used,
            solution_.num_views[c],
            figures.num_outliers,
            100.0 * figures.coverage,
            focal,
            open.focal * focal));
        const double late = figures.late_instants;
        const auto all = static_cast<double>(figures.num_used + figures.num_outliers);
        const double outliers = static_cast<double>(figures.num_outliers) / std::max(1.0, all);
        if (std::abs(late) >= kLateBoard) {
            verdict_.problems.push_back(fmt::format(
                "camera '{}' is {} by {:.1f} instants ({:.0f} ms): its pictures fit the "
                "motion of the board at another time; check its trigger, or hold the "
                "board still at each place",
                name(c),
                late > 0.0 ? "late" : "early",
                std::abs(late),
                1000.0 * std::abs(late) / rate_hz_));
        } else if (outliers > kManyBoardOutliers) {
            verdict_.problems.push_back(
                fmt::format("camera '{}' contradicts the others in {:.0f} % of its corners: it was "
                            "moved meanwhile, or its pictures are those of another camera or time",
                            name(c),
                            100.0 * outliers));
        } else if (solution_.num_views[c] < kTooFewViews) {
            verdict_.problems.push_back(
                fmt::format("camera '{}' shows the board in {} pictures only; show it the board at "
                            "20 places",
                            name(c),
                            solution_.num_views[c]));
        } else if (open.focal > kOpenFocal) {
            verdict_.problems.push_back(fmt::format(
                "the focal length of '{}' is open: {:.0f} px, give or take {:.0f}. It saw the "
                "board "
                "frontally, or small. Tilt the board by 30 to 60 degrees to all sides before it",
                name(c),
                focal,
                open.focal * focal));
        } else {
            check_camera(c);
        }
    }

    void check_camera(std::size_t c) {
        const CameraFigures& figures = rig_.cameras[c];
        const double focal = rig_.bundle.cameras[c].lens[0];
        if (solution_.uncertainties[c].focal > kVagueFocal)
            verdict_.checks.push_back(fmt::format(
                "the focal length of '{}' is known to {:.1f} of {:.0f} px only: tilt the board by "
                "30 to 60 degrees to all sides before it",
                name(c),
                solution_.uncertainties[c].focal * focal,
                focal));
        const double own = solution_.own_focals_px[c];
        if (std::abs(own / focal - 1.0) > kOtherFocal)
            verdict_.checks.push_back(fmt::format(
                "the focal length of '{}' is {:.0f} px by its own pictures, and {:.0f} px together "
                "with the others: the board bends, or moves between their pictures; hold it still, "
                "and tilt it more before this camera",
                name(c),
                own,
                focal));
        if (solution_.num_views[c] < kFewViews)
            verdict_.checks.push_back(
                fmt::format("camera '{}' shows the board in {} pictures only; 20 are better",
                            name(c),
                            solution_.num_views[c]));
        if (rig_.cameras.size() > 1 && solution_.num_shared[c] < kFewSharedViews)
            verdict_.checks.push_back(
                fmt::format("camera '{}' shows the board together with others in {} pictures only; "
                            "10 are better",
                            name(c),
                            solution_.num_shared[c]));
        if (figures.coverage < kSmallBoardCoverage)
            verdict_.checks.push_back(fmt::format(
                "camera '{}' saw corners in {:.0f} % of its picture only; outside of these its "
                "lens is a guess: show it the board there, too",
                name(c),
                100.0 * figures.coverage));
    }

    const BoardSolution& solution_;
    const WandSolution& rig_;
    double rate_hz_;
    Verdict verdict_;
};

}  // namespace

Verdict judge_board(const BoardSolution& solution, double rate_hz) {
    return BoardJudge(solution, rate_hz).run();
}

std::string same_board_pictures(const BoardPoints& points) {
    LightPoints lights;
    for (const BoardCamera& camera : points) {
        lights.push_back({camera.name, {}});
        for (const BoardCorner& corner : camera.corners)
            lights.back().points.push_back({corner.instant, std::nullopt, corner.px});
    }
    return same_pictures(lights);
}

}  // namespace atrium::calibrate
