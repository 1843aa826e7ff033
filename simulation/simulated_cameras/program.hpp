#pragma once

#include "core/config/rig.hpp"
#include "core/image/raw_image.hpp"
#include "simulation/simulated_cameras/config.hpp"

#include <stop_token>
#include <string>
#include <vector>

namespace atrium::simulated_cameras {

/// A configuration that was checked, with what it names.
struct Plan {
    SimulatedCamerasConfig config;
    config::Rig rig;
    image::PixelFormat format = image::PixelFormat::kBayerRG;
    Faults faults;
    std::vector<std::string> command;  // empty: serve until the stop
};
Expected<Plan> make_plan(const SimulatedCamerasConfig& config, std::vector<std::string> command);

/// The cameras as a table on standard output.
void print(const Plan& plan);

/// Makes the network that the cameras are in, and this process' own; before any thread is started.
Expected<void> enter_network(const Plan& plan);

/// Loads the pictures, serves them and runs the command. Returns its exit code, 0 without one.
Expected<int> run(const Plan& plan, std::stop_token stop);

}  // namespace atrium::simulated_cameras
