#pragma once

#include "world_server/description/world_description.hpp"

#include <string>
#include <vector>

namespace atrium::world_server {

/// Adds a line for each soft object that starts inside a rigid one, and for each tie that is far
/// from the object it is tied to.
void doubt_soft(const WorldDescription& world, std::vector<std::string>& lines);

}  // namespace atrium::world_server
