#pragma once

#include "world_server/description/world_description.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace atrium::world_server {

/// Adds a line for each object that carries so many times its mass that it slides, falls or is torn
/// at this rate: objects that rest on it at the start, or that hang from it by joints.
void doubt_loads(const WorldDescription& world, double tick_hz, std::vector<std::string>& lines);

/// Returns the mass of what rests on each object, or starts within 10 cm above it, by id [kg].
/// Leaves out what is joined to it, and planes.
std::map<std::uint32_t, double> carried_kg(const WorldDescription& world);

}  // namespace atrium::world_server
