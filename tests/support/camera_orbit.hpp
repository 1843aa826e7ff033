#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "simulation/person.hpp"
#include "tests/support/person_photographer.hpp"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace atrium::test {

/// Pictures of `width_px` by `height_px` that show a standing person before `target`.
geometry::CalibratedCamera camera_at(const Eigen::Vector3d& position_site,
                                     const Eigen::Vector3d& target_site,
                                     int width_px,
                                     int height_px,
                                     double focal_px);

/// Cameras on a level circle around (0, 0), all looking at its axis; the first one stands at +X.
std::vector<geometry::CalibratedCamera> orbit(
    int num_steps, double radius_m, double height_m, int width_px, int height_px, double focal_px);

/// Viewpoints all around and at heights from knees to above the head, evenly spread.
std::vector<geometry::CalibratedCamera> free_viewpoints(int count, int side_px, double focal_px);

/// The simulated person alone on grey, as `room_cameras` make its room's light fall: the true
/// surface in its true colours.
Expected<std::vector<Photo>> photograph_truth(
    std::span<const geometry::CalibratedCamera> room_cameras,
    const simulation::RoomOptions& options,
    double time_s,
    std::span<const geometry::CalibratedCamera> cameras);

/// How much pictures of a smooth way change from each to the next.
struct PictureChanges {
    double largest = 0.0;  // of the means over the picture of the absolute differences, grey levels
    double largest_block = 0.0;  // of the means over blocks of 16 x 16 pixels
    double mean = 0.0;
};
PictureChanges changes(std::span<const Photo> photos);

}  // namespace atrium::test
