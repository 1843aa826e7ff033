#pragma once

#include "core/config/table_reader.hpp"
#include "world_server/description/material.hpp"
#include "world_server/description/world_object.hpp"

#include <vector>

namespace atrium::world_server {

/// Reads `[[object]]`, models included. Problems are kept by `reader`.
void read_objects(config::TableReader& reader,
                  const Materials& materials,
                  std::vector<WorldObject>& objects);

}  // namespace atrium::world_server
