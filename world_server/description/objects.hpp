#pragma once

#include "core/config/table_reader.hpp"
#include "world_server/description/material.hpp"
#include "world_server/description/world_object.hpp"

#include <vector>

namespace atrium::world_server {

/// Reads all `[[object]]` tables, including their models. Problems go to `reader`.
void read_objects(config::TableReader& reader,
                  const Materials& materials,
                  std::vector<WorldObject>& objects);

}  // namespace atrium::world_server
