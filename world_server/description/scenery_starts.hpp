#pragma once

#include "world_server/description/world_description.hpp"

#include <string>
#include <vector>

namespace atrium::world_server {

/// Adds a line for each moving object without a joint that starts on scenery that is not solid,
/// with nothing else below it: it will fall through.
void doubt_starts_on_scenery(const WorldDescription& world, std::vector<std::string>& lines);

/// Adds a line for each moving object, puppet and soft object that starts in solid scenery: in its
/// surface, or inside a part that is a closed body.
void doubt_starts_in_scenery(const WorldDescription& world, std::vector<std::string>& lines);

}  // namespace atrium::world_server
