#pragma once

#include "core/config/rig.hpp"
#include "core/image/raw_image.hpp"
#include "tools/simulated_cameras/config.hpp"

#include <stop_token>
#include <string>
#include <vector>

namespace atrium::simulated_cameras {

/// A checked configuration with its rig, format and faults.
struct Plan {
    SimulatedCamerasConfig config;
    config::Rig rig;
    image::PixelFormat format = image::PixelFormat::kBayerRG;
    Faults faults;
    std::vector<std::string> command;  // empty: serve until the stop
};
Expected<Plan> make_plan(const SimulatedCamerasConfig& config, std::vector<std::string> command);

/// Prints the cameras as a table to standard output.
void print(const Plan& plan);

/// Creates and enters the private network of the cameras. Call it before any thread starts.
Expected<void> enter_network(const Plan& plan);

/// Writes the recording that `config.write_recording` asks for.
Expected<void> write(const Plan& plan, std::stop_token stop);

/// Loads and serves the pictures and runs the command. Returns its exit code, 0 without a command.
Expected<int> run(const Plan& plan, std::stop_token stop);

}  // namespace atrium::simulated_cameras
