#pragma once

#include "world_server/description/world_description.hpp"

#include <string>
#include <vector>

namespace atrium::world_server {

/// Adds a line for each friction and each density that no material has, and for each spring that
/// is much too long or short at the start, or that throws its objects.
void doubt_amounts(const WorldDescription& world, std::vector<std::string>& lines);

}  // namespace atrium::world_server
