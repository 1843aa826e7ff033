#pragma once

#include "core/config/table_reader.hpp"
#include "world_server/description/material.hpp"
#include "world_server/description/world_object.hpp"
#include "world_server/physics/rigid/joint.hpp"

#include <vector>

namespace atrium::world_server {

/// Reads all `[[puppet]]` tables. Parts get the ids after those of `objects`. Problems go to
/// `reader`.
void read_puppets(config::TableReader& reader,
                  const Materials& materials,
                  std::vector<WorldObject>& objects,
                  std::vector<physics::Joint>& joints);

}  // namespace atrium::world_server
