#pragma once

#include "tools/calibrate/wand/light_points.hpp"
#include "tools/calibrate/wand/solve_wand.hpp"

namespace atrium::calibrate {

/// Fills the instants, sightings and numbers of points of a solution with the lights of the wand
/// that the points of each picture show on their own. Cameras of `points` that the solution does
/// not have are passed over. Errors name camera and instant, or tell that hardly any picture shows
/// this wand.
Expected<void> find_lights(const LightPoints& points, WandSolution& solution);

/// Takes the points within `most_px` of where lights of the placed wands must be seen: also in
/// pictures in which a light is missing, or whose labels were not clear. Sightings of other points
/// that were labelled on their own stay: they contradict the solution, and count.
void find_lights_at_places(const LightPoints& points, double most_px, WandSolution& solution);

}  // namespace atrium::calibrate
