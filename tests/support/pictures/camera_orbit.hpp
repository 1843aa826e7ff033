#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "simulation/person.hpp"
#include "tests/support/pictures/filmed_person.hpp"
#include "tests/support/pictures/person_photographer.hpp"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace atrium::test {

/// Pictures of `width_px` by `height_px` that show a standing person in front of `target`.
geometry::CalibratedCamera camera_at(const Eigen::Vector3d& position_site,
                                     const Eigen::Vector3d& target_site,
                                     int width_px,
                                     int height_px,
                                     double focal_px);

/// Cameras on a level circle around (0, 0), all looking at its axis. The first one stands at +X.
std::vector<geometry::CalibratedCamera> orbit(
    int num_steps, double radius_m, double height_m, int width_px, int height_px, double focal_px);

/// Viewpoints in all directions, at heights from the knees to above the head, evenly spread.
std::vector<geometry::CalibratedCamera> free_viewpoints(int count, int side_px, double focal_px);

/// The simulated person alone on grey, lit as in the room of `room_cameras`: the true surface in
/// its true colours.
Expected<std::vector<Photo>> photograph_truth(
    std::span<const geometry::CalibratedCamera> room_cameras,
    const simulation::RoomOptions& options,
    double time_s,
    std::span<const geometry::CalibratedCamera> cameras);

/// Pictures of the simulated person, lit likewise, before a green screen. Pixels at the outline mix
/// both. The mask is where the person covers at least half of a pixel.
Expected<std::vector<TruePicture>> film_before_screen(
    std::span<const geometry::CalibratedCamera> room_cameras,
    const simulation::RoomOptions& options,
    double time_s,
    std::span<const geometry::CalibratedCamera> cameras);

/// Differences between consecutive pictures along a smooth path.
struct PictureChanges {
    double largest = 0.0;        // of the mean absolute difference over a picture, in grey levels
    double largest_block = 0.0;  // of the mean over a block of 16 x 16 pixels
    double mean = 0.0;
};
PictureChanges changes(std::span<const Photo> photos);

}  // namespace atrium::test
