#pragma once

#include "core/config/table_reader.hpp"
#include "core/geometry/rigid_transform.hpp"

#include <string>
#include <vector>

namespace atrium::world_server {

struct NamedPlacement {
    std::string site;
    geometry::RigidTransform world_from_site;
};

/// Reads all `[[site]]` tables. Problems go to `reader`.
void read_placements(config::TableReader& reader, std::vector<NamedPlacement>& placements);

}  // namespace atrium::world_server
