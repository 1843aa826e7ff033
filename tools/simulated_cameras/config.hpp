#pragma once

#include "core/config/option_set.hpp"
#include "simulation/room_config.hpp"
#include "tools/simulated_cameras/faults.hpp"

#include <filesystem>
#include <string>

namespace atrium::simulated_cameras {

struct SimulatedCamerasConfig {
    std::filesystem::path rig;              // for a simulated room
    std::filesystem::path recording;        // folder, instead of a rig
    std::filesystem::path write_recording;  // folder; empty: serve
    double rate_hz = 0.0;                   // 0: the rig's
    std::string pixel_format = "BayerRG8";
    double empty_seconds = 5.0;
    double seconds = 0.0;  // 0: until the command ends or Ctrl-C
    bool stamp = false;
    bool list = false;
    bool own_network = true;
    std::uint64_t seed = 1;
    FaultTexts faults;
    simulation::RoomConfig simulation;
};

/// Declares every option with its default; `config` must outlive `set`.
void declare(SimulatedCamerasConfig& config, config::OptionSet& set);

/// Checks rules that span several options.
Expected<void> check(const SimulatedCamerasConfig& config);

}  // namespace atrium::simulated_cameras
