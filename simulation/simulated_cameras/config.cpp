#include "simulation/simulated_cameras/config.hpp"

#include "simulation/simulated_cameras/sensor.hpp"

namespace atrium::simulated_cameras {

void declare(SimulatedCamerasConfig& config, config::OptionSet& set) {
    set.add("rig", config.rig, "cameras of the simulated room: a rig.toml");
    set.add("recording", config.recording, "serve this recording instead: its folder");
    set.add("rate_hz",
            config.rate_hz,
            "pictures per second until a client asks for others [Hz]; 0: the rig's",
            {0, 240});
    set.add("pixel_format",
            config.pixel_format,
            "what the sensors deliver; a client that asks for another one gets grey",
            pixel_format_names());
    set.add("empty_seconds",
            config.empty_seconds,
            "how long the room is empty, from the first picture and from each SIGUSR1 on [s]",
            {0, 1e6});
    set.add("seconds",
            config.seconds,
            "how long to serve [s]; 0: until the command ends, or Ctrl-C",
            {0, 1e9});
    set.add("stamp",
            config.stamp,
            "write the number of camera and trigger into the corner of each picture");
    set.add("list", config.list, "print the cameras and end");
    set.add("own_network",
            config.own_network,
            "false: serve in the network that is there, whose loopback must have the addresses");
    set.add("lose",
            config.faults.lose,
            "packets that a camera loses [%]: CAMERA=PERCENT,...; a camera is a name or a number");
    set.add("delay_ms",
            config.faults.delay_ms,
            "how long a camera holds its pictures back [ms]: CAMERA=MS,...");
    set.add("clock_offset_ms",
            config.faults.clock_offset_ms,
            "what a camera's clock is ahead of the others [ms]: CAMERA=MS,...");
    set.add("stop",
            config.faults.stop,
            "switch a camera off for a while, in seconds after the first picture: "
            "CAMERA@FROM+SECONDS,...");
    set.add(
        "restart", config.faults.restart, "switch a camera off and on at once: CAMERA@FROM,...");
    set.add("seed", config.seed, "of lost packets");
    simulation::declare(config.simulation, set);
}

Expected<void> check(const SimulatedCamerasConfig& config) {
    if (config.rig.empty() && config.recording.empty()) {
        return make_error(ErrorKind::kConfiguration,
                          "rig, recording: one of them is needed, for example --rig "
                          "deploy/rigs/full_body.toml");
    }
    if (!config.rig.empty() && !config.recording.empty()) {
        return make_error(ErrorKind::kConfiguration,
                          "rig, recording: both are given; a recording has a rig of its own");
    }
    return {};
}

}  // namespace atrium::simulated_cameras
