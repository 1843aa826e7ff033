#pragma once

#include "core/app/process.hpp"
#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"
#include "core/config/option_set.hpp"
#include "core/config/table_reader.hpp"
#include "world_server/description/soft_objects.hpp"
#include "world_server/description/world_object.hpp"
#include "world_server/physics/people/person_shape.hpp"
#include "world_server/physics/world.hpp"
#include "world_server/placement.hpp"
#include "world_server/rights.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace atrium::world_server {

struct WorldServerConfig {
    bus::BusOptions bus;
    app::ProcessOptions process;
    double tick_hz = 120.0;
    double send_hz = 60.0;
    double seconds = 0.0;  // run time; 0: until stopped
    int max_objects = 256;
    int max_sites = 16;
    physics::WorldOptions world;  // tick_s and max_objects are derived from the above
    physics::PersonShapeOptions person;
    std::vector<WorldObject> objects;    // ids from 1; parts of puppets last
    std::vector<WorldSoftObject> soft;   // ids continue after `objects`
    std::vector<physics::Joint> joints;  // refer to `objects` by id
    std::vector<WorldScenery> scenery;
    std::vector<NamedPlacement> placements;
    Rights rights;
    std::filesystem::path state_file;  // empty: no saving, no restoring
    double save_every_s = 30.0;        // 0: only at the end and on command
};

/// Declares every plain option; `config` must outlive `set`.
void declare(WorldServerConfig& config, config::OptionSet& set);

/// Reads the settings that exist only in a world file (description/world_file.cpp): gravity,
/// bounds, materials, objects, puppets, soft objects, joints, scenery, sites and rights. Call after
/// the plain options are read. Problems go to `reader`.
void read_world(config::TableReader& reader, WorldServerConfig& config);

/// Checks conditions that involve several options.
Expected<void> check(const WorldServerConfig& config);

}  // namespace atrium::world_server
