#pragma once

#include "core/base/expected.hpp"
#include "tools/calibrate/adjust/uncertainty.hpp"
#include "tools/calibrate/board/board.hpp"
#include "tools/calibrate/board/board_points.hpp"
#include "tools/calibrate/board/place_rig.hpp"
#include "tools/calibrate/wand/solve_wand.hpp"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace atrium::calibrate {

struct BoardOptions {
    LensFreedom lens = LensFreedom::kAll;
    int num_threads = 1;
    /// Errors above this many sigmas of a coordinate count less (Cauchy), and corners above
    /// `outlier_sigmas`, but at least 1 px, do not count. Wider than for lights: corners have
    /// numbers, and the board's motion between the pictures of cameras without a trigger gives
    /// errors of any size, which are no outliers (docs/measurements/calibration.md).
    double robust_sigmas = 8.0;
    double outlier_sigmas = 10.0;
    /// Called with a short text when a step begins, or null.
    std::function<void(const std::string&)> report;
};

/// Two cameras between which the boards leave two places about equally likely.
struct Ambiguity {
    std::size_t a = 0, b = 0;
    double turn_deg = 0.0;  // between the two
    double median_px = 0.0, rival_px = 0.0;
};

struct BoardSolution {
    /// As of a wand, whose lights are the corners of all boards. The pose of board b at the i-th
    /// instant is `wands[b * num_instants + i]`; `instants` counts in the same way. Errors are of
    /// corners; those held out are of a fifth of the instants, at which only the boards were
    /// placed, with cameras that did not use them.
    WandSolution rig;
    std::vector<CameraUncertainty> uncertainties;  // per camera
    std::vector<std::size_t> num_views;            // per camera: pictures with boards that fit
    std::vector<std::size_t> num_shared;           // the same, with another camera's
    std::vector<double> own_focals_px;             // per camera: from its own pictures alone
    std::vector<CameraPair> pairs;
    std::vector<Ambiguity> ambiguities;
    double sigma_px = 0.0;  // of a coordinate of a corner
};

/// The bundle of these points, without any places and with no lens, and the instants of its poses.
struct BoardBundle {
    Bundle bundle;
    std::vector<std::uint32_t> instants;
};
BoardBundle bundle_of(const std::vector<Board>& boards, const BoardPoints& points);

/// Calibrates cameras from boards without a guess: each lens from its own views (start_lens.hpp),
/// the poses along pairs of cameras (place_rig.hpp), then all together (adjust/bundle.hpp).
/// Errors kInvalidData name cameras that cannot be placed, with the cause and the cure.
Expected<BoardSolution> solve_board(const std::vector<Board>& boards,
                                    const BoardPoints& points,
                                    const BoardOptions& options);

}  // namespace atrium::calibrate
