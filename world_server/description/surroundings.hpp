#pragma once

#include "core/config/table_reader.hpp"
#include "world_server/description/material.hpp"
#include "world_server/description/world_object.hpp"
#include "world_server/physics/world.hpp"

#include <vector>

namespace atrium::world_server {

/// Reads `[bounds]`, which takes the place of world.half_extent_m and world.lowest_z_m. Problems
/// are kept by `reader`.
void read_bounds(config::TableReader& reader, physics::WorldOptions& world);

/// Reads `[[scenery]]`, with the models of what is solid. Problems are kept by `reader`.
void read_scenery(config::TableReader& reader,
                  const Materials& materials,
                  std::vector<WorldScenery>& scenery);

}  // namespace atrium::world_server
