#pragma once

#include "core/config/table_reader.hpp"
#include "world_server/description/rights.hpp"
#include "world_server/description/site_placements.hpp"
#include "world_server/description/soft_objects.hpp"
#include "world_server/description/world_object.hpp"
#include "world_server/physics/rigid/joint.hpp"
#include "world_server/physics/world.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace atrium::world_server {

/// The contents of a world file, without the plain options of the server.
struct WorldDescription {
    std::string objects_at;  // as errors name it: "w.toml:7", or the file if it has none
    // likewise; empty if the file lacks the keys
    std::string rates_at, max_objects_at, max_sites_at;
    physics::WorldOptions world;         // the file gives gravity and bounds
    std::vector<WorldObject> objects;    // ids from 1; parts of puppets last
    std::vector<WorldSoftObject> soft;   // ids continue after `objects`
    std::vector<physics::Joint> joints;  // refer to `objects` by id
    std::vector<WorldScenery> scenery;
    std::vector<NamedPlacement> placements;
    std::filesystem::path models_folder;  // of the files that the description names; empty: none
    Rights rights;
};

/// Returns the object with this id; null if there is none, or it is the world (0).
const WorldObject* object_of(const WorldDescription& world, std::uint32_t id);

/// Reads the settings that exist only in a world file: folder of models, gravity, bounds,
/// materials, objects, puppets, soft objects, joints, scenery, sites and rights. Call after the
/// plain options are read. Problems go to `reader`.
void read_world(config::TableReader& reader, WorldDescription& description);

}  // namespace atrium::world_server
