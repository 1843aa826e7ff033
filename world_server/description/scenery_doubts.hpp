#pragma once

#include "world_server/description/world_description.hpp"

#include <string>
#include <vector>

namespace atrium::world_server {

/// Adds a line for each piece of scenery that is much larger than the world or tiny, far outside
/// the world, or out of sight below a floor or in a fixed box.
void doubt_scenery(const WorldDescription& world, std::vector<std::string>& lines);

}  // namespace atrium::world_server
