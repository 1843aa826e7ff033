#pragma once

#include "world_server/description/world_description.hpp"

#include <string>
#include <vector>

namespace atrium::world_server {

/// Adds a line for each hinge or slider without `collide` that opens in one direction only, into
/// its other object, though it would be free in the other direction: its axis has the wrong sign.
/// Of sliders only those that start inside the other object, as drawers do.
void doubt_reversed(const WorldDescription& world, std::vector<std::string>& lines);

}  // namespace atrium::world_server
