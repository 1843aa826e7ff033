#pragma once

#include "core/app/process.hpp"
#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"
#include "core/config/option_set.hpp"
#include "world_server/description/world_description.hpp"
#include "world_server/physics/people/person_shape.hpp"

#include <filesystem>

namespace atrium::world_server {

/// Options of a run from a recording (recorded_run.hpp).
struct RecordingOptions {
    std::filesystem::path file;    // empty: a live world
    std::filesystem::path output;  // empty: none
    bool hashes = false;           // logs the state's hash after each second
    bool commands = true;          // commands and edits of the recording, too
    bool real_time = false;        // as fast as recorded; otherwise as fast as possible
    int threads = 0;               // that prepare meshes; 0: one per core, at most four
};

/// A described world and the options of the server. `world.tick_s` and `world.max_objects` follow
/// from `tick_hz` and `max_objects`.
struct WorldServerConfig : WorldDescription {
    bus::BusOptions bus;
    app::ProcessOptions process;
    double tick_hz = 120.0;
    double send_hz = 60.0;
    double seconds = 0.0;  // run time; 0: until stopped
    int max_objects = 256;
    int max_sites = 16;
    physics::PersonShapeOptions person;
    std::filesystem::path state_file;    // empty: no saving, no restoring
    double save_every_s = 30.0;          // 0: only at the end and on command
    std::filesystem::path saved_folder;  // of saved worlds; empty: none
    int max_saved = 64;
    RecordingOptions recording;
    std::string loaded{};  // saved world that the description is from; empty: the world file
    std::uint64_t world_file_hash = 0;  // of what the world file describes; 0: not known yet
};

/// Declares every plain option; `config` must outlive `set`.
void declare(WorldServerConfig& config, config::OptionSet& set);

/// Checks conditions that involve several options.
Expected<void> check(const WorldServerConfig& config);

}  // namespace atrium::world_server
