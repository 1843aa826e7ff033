#pragma once

#include "world_server/description/world_description.hpp"

#include <string>
#include <vector>

namespace atrium::world_server {

/// Adds a line for each moving object, puppet and soft object that starts in solid scenery: in its
/// surface, or inside a part that is a closed body.
void doubt_starts_in_scenery(const WorldDescription& world, std::vector<std::string>& lines);

}  // namespace atrium::world_server
