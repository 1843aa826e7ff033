#pragma once

#include "core/geometry/surface_tree.hpp"
#include "world_server/description/world_description.hpp"

#include <functional>
#include <string>
#include <vector>

namespace atrium::world_server {

/// How deep something is inside a closed surface in the frame of `object` [m].
using DepthInSurface = std::function<double(const geometry::SurfaceTree& surface)>;

/// Returns why something that overlaps the hulls of `object` by `overlap_m` is inside it, and what
/// to do, if it lies in a hollow of the model: inside the hulls, but hardly in what the model's own
/// surface encloses. Ends with "or "; empty for other objects and models that are not closed.
std::string cause_in_hollow(const WorldObject& object,
                            double overlap_m,
                            const DepthInSurface& depth_m);

/// Adds a line for each model that a compound should keep hollow but cannot, because its file has
/// one part: its closed surface encloses less than half of the hull. A convex shape is said to be
/// one hull, and compounds of several parts are split on purpose: they are not doubted. `lines`
/// that name the cause already are enough.
void doubt_hollows(const WorldDescription& world, std::vector<std::string>& lines);

}  // namespace atrium::world_server
