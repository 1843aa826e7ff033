#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

/// Up and floor from measured heights of cameras. Pure functions; lengths in metres.
namespace atrium::calibrate {

struct MeasuredHeight {
    std::size_t camera = 0;  // index
    double metres = 0.0;     // above the floor
};

/// A direction that is known to about `error_deg`.
struct UpGuess {
    Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    double error_deg = 5.0;
};

struct HeightFit {
    Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    double floor_m = 0.0;         // a camera at c hangs c.dot(up) - floor_m above the floor
    double deviation_m = 0.0;     // largest difference from a measured height
    double error_deg = 0.0;       // likely error of `up`, in the direction that is known worst
    bool has_both_tilts = false;  // false: along one direction, `up` comes from the guess
};
/// Fits up and floor to the heights of the cameras at `centres`. What the heights leave open is
/// taken from `guess`.
HeightFit fit_heights(std::span<const Eigen::Vector3d> centres,
                      std::span<const MeasuredHeight> heights,
                      const UpGuess& guess);

/// As `fit_heights`, where up is known.
HeightFit fit_floor(std::span<const Eigen::Vector3d> centres,
                    std::span<const MeasuredHeight> heights,
                    const Eigen::Vector3d& up);

struct OddHeight {
    std::size_t index = 0;      // in the heights
    bool is_clear = true;       // false: another one may be the odd one
    double others_say_m = 0.0;  // where the other heights put this camera
};
/// Finds the height without which the others agree best, with each other and with `guess`. None for
/// less than three heights.
std::optional<OddHeight> odd_height(std::span<const Eigen::Vector3d> centres,
                                    std::span<const MeasuredHeight> heights,
                                    const UpGuess& guess);

/// Factor on the distances of the cameras with which the heights would agree; none if another
/// factor does not help, or the heights do not tell it: they need four cameras that stand in no
/// plane.
std::optional<double> scale_of_heights(std::span<const Eigen::Vector3d> centres,
                                       std::span<const MeasuredHeight> heights,
                                       const Eigen::Vector3d& up);

}  // namespace atrium::calibrate
