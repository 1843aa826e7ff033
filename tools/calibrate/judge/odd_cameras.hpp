#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "tools/calibrate/judge/reading.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

/// Finds cameras of a rig whose pose was written in another way than those of the others, as
/// happens where the files of several programs or scripts are put together. Pure functions.
namespace atrium::calibrate {

/// Cameras whose lengths are in another unit than those of the others.
struct OddUnit {
    std::vector<std::size_t> cameras;
    double factor = 1.0;  // takes their lengths into the others' unit: 10, 100, 1000 or an inverse
};

/// Finds the cameras that fit to the others only if their lengths are taken in another unit; fewer
/// than half of all. `cameras` give the lenses, `poses` belong to them; they are read as the
/// cameras prove, or as `fixed`. `documented`, `are_matrices`: see choose_reading.
std::optional<OddUnit> find_odd_unit(std::span<const geometry::CalibratedCamera> cameras,
                                     std::span<const ForeignPose> poses,
                                     const Reading& documented,
                                     std::optional<Reading> fixed,
                                     bool are_matrices);

/// The reading in which the camera `odd`, which does not look at the place that the others look at
/// if it is read as they are, `common`, does so, upright and from a usual distance; the likeliest
/// of several. `others` are the cameras that look there. None if no reading fits, or if they are
/// fewer than three.
std::optional<Reading> find_odd_reading(const geometry::CalibratedCamera& odd,
                                        const ForeignPose& pose,
                                        std::span<const geometry::CalibratedCamera> others,
                                        const Reading& common);

}  // namespace atrium::calibrate
