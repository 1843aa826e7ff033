#pragma once

#include "core/config/table_reader.hpp"
#include "world_server/description/world_object.hpp"
#include "world_server/physics/rigid/joint.hpp"

#include <vector>

namespace atrium::world_server {

/// Reads all `[[joint]]` tables. They refer to `objects`, including parts of puppets, by name.
/// Problems go to `reader`.
void read_joints(config::TableReader& reader,
                 const std::vector<WorldObject>& objects,
                 std::vector<physics::Joint>& joints);

}  // namespace atrium::world_server
