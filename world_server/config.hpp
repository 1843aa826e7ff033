#pragma once

#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"
#include "core/config/option_set.hpp"
#include "core/config/table_reader.hpp"
#include "world_server/physics/person_shape.hpp"
#include "world_server/physics/world.hpp"
#include "world_server/placement.hpp"
#include "world_server/soft_config.hpp"

#include <string>
#include <vector>

namespace atrium::world_server {

/// One object of the world as the file describes it. The object's id is its place in the file,
/// counted from 1.
struct WorldObject {
    bus::SceneObject scene;
    double friction = 0.6;
    double restitution = 0.2;
};

struct WorldServerConfig {
    bus::BusOptions bus;
    double tick_hz = 120.0;
    double send_hz = 60.0;
    double seconds = 0.0;  // how long to run; 0: until stopped
    int max_objects = 256;
    int max_sites = 16;
    physics::WorldOptions world;  // tick_s and max_objects follow from the above
    physics::PersonShapeOptions person;
    std::vector<WorldObject> objects;
    std::vector<WorldSoftObject> soft;  // ids go on from those of `objects`
    std::vector<NamedPlacement> placements;
};

/// Declares every plain option; `config` must outlive `set`.
void declare(WorldServerConfig& config, config::OptionSet& set);

/// Reads `world.gravity`, `[[object]]`, `[[soft]]` and `[[site]]`. Problems are kept by `reader`.
void read_world(config::TableReader& reader, WorldServerConfig& config);

/// What options cannot check one by one.
Expected<void> check(const WorldServerConfig& config);

}  // namespace atrium::world_server
