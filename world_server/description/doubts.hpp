#pragma once

#include "world_server/description/world_description.hpp"

#include <string>
#include <vector>

namespace atrium::world_server {

/// Lists what is valid in a world file but probably meant otherwise, one log line each: textures
/// and colours of model files, which viewers do not draw; joints far outside the world, far from
/// their objects, blocked or written twice; radians and other wrong units; gravity that does not
/// point down; soft models with few large triangles; objects that start inside others, or that
/// carry many times their mass; ties far from their objects; densities, frictions and springs that
/// nothing real has; a world without objects or floor; scenery that is huge, tiny, far outside the
/// world or out of sight; sites at one place.
std::vector<std::string> doubts_about(const WorldDescription& world, double tick_hz);

}  // namespace atrium::world_server
