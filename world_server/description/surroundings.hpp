#pragma once

#include "core/config/table_reader.hpp"
#include "world_server/description/material.hpp"
#include "world_server/description/world_object.hpp"
#include "world_server/physics/world.hpp"

#include <vector>

namespace atrium::world_server {

/// Reads `[bounds]`, which replaces world.half_extent_m and world.lowest_z_m. Problems go to
/// `reader`.
void read_bounds(config::TableReader& reader, physics::WorldOptions& world);

/// Reads all `[[scenery]]` tables, with the models of solid scenery. Problems go to `reader`.
void read_scenery(config::TableReader& reader,
                  const Materials& materials,
                  std::vector<WorldScenery>& scenery);

}  // namespace atrium::world_server
