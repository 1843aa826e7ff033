#pragma once

#include "core/config/table_reader.hpp"
#include "world_server/description/world_object.hpp"
#include "world_server/physics/joint.hpp"

#include <vector>

namespace atrium::world_server {

/// Reads `[[joint]]`, which joins `objects` (parts of puppets among them) by their names. Problems
/// are kept by `reader`.
void read_joints(config::TableReader& reader,
                 const std::vector<WorldObject>& objects,
                 std::vector<physics::Joint>& joints);

}  // namespace atrium::world_server
