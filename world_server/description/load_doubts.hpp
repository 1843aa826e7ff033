#pragma once

#include "world_server/description/world_description.hpp"

#include <string>
#include <vector>

namespace atrium::world_server {

/// Adds a line for each object that carries so many times its mass that it slides, falls or is torn
/// at this rate: objects that rest on it at the start, or that hang from it by joints.
void doubt_loads(const WorldDescription& world, double tick_hz, std::vector<std::string>& lines);

}  // namespace atrium::world_server
