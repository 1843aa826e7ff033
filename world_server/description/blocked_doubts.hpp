#pragma once

#include "world_server/description/world_description.hpp"

#include <string>
#include <vector>

namespace atrium::world_server {

/// Adds a line for each hinge and slider that fixed objects or solid scenery stop at its start: in
/// a small simulation without gravity and other movable things, its object is pushed in each
/// direction that its limits allow, and hardly moves in any. Also for each slider that the fixed
/// object in which it starts stops early, though it would be free in the other direction. Leaves
/// out the joints of puppets.
void doubt_blocked(const WorldDescription& world, std::vector<std::string>& lines);

}  // namespace atrium::world_server
