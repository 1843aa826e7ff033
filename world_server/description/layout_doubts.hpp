#pragma once

#include "world_server/description/world_description.hpp"

#include <string>
#include <vector>

namespace atrium::world_server {

/// Adds a line for a world without objects, for one in which objects fall and nothing carries them,
/// and for each site that stands at the place of another.
void doubt_layout(const WorldDescription& world, std::vector<std::string>& lines);

}  // namespace atrium::world_server
