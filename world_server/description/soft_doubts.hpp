#pragma once

#include "world_server/description/world_description.hpp"

#include <string>
#include <vector>

namespace atrium::world_server {

/// Adds a line for each soft object that starts inside a rigid one or has pins inside one that
/// moves, and for each tie that is far from the object it is tied to. What a soft object is tied to
/// it may start in.
void doubt_soft(const WorldDescription& world, std::vector<std::string>& lines);

}  // namespace atrium::world_server
