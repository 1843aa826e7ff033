#pragma once

#include "world_server/description/world_description.hpp"

#include <string>
#include <vector>

namespace atrium::world_server {

/// Returns the tables of a world file, for `read_world`: gravity, bounds, `objects`, `soft`, the
/// joints whose ends are left, scenery, sites and rights. Materials and puppets appear as objects
/// with explicit values. Positions are rounded to a micrometre, angles to a millionth of a degree.
/// `world_table` starts the table [world]; it ends with a newline.
std::string to_toml(const WorldDescription& description,
                    const std::vector<WorldObject>& objects,
                    const std::vector<WorldSoftObject>& soft,
                    const std::string& world_table);

}  // namespace atrium::world_server
