#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "tools/calibrate/adjust/bundle.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace atrium::calibrate {

/// Where a board may stand before a camera that sees it.
struct BoardPlace {
    geometry::RigidTransform camera_from_board;
    double rms_px = 0.0;
};

/// A board in one picture. The bundle's `wand` holds the corners of all boards, each in its own
/// frame, and each board has a pose, `Bundle::wands`, of its own at each instant.
struct BoardView {
    std::uint32_t camera = 0;
    std::uint32_t pose = 0;          // index in Bundle::wands
    std::size_t begin = 0, end = 0;  // in Bundle::sightings
    /// Best first. A small or distant board may have two places that explain its picture about as
    /// well: one leans to the camera where the other leans away.
    std::vector<BoardPlace> places;
};

/// The views of a bundle, without places.
std::vector<BoardView> views_of(const Bundle& bundle);

/// Finds the places of a board in a view with the camera's lens as it is: IPPE (Collins and
/// Bartoli, 2014), each then refined. None if the lens cannot undistort the corners.
std::vector<BoardPlace> find_places(const Bundle& bundle, const BoardView& view);

/// Whether a view shows the board in about this place: the median error of some corners [px].
double error_of_place(const Bundle& bundle,
                      const BoardView& view,
                      const geometry::RigidTransform& camera_from_board);

}  // namespace atrium::calibrate
