#include "tools/simulated_cameras/config.hpp"

#include "tools/simulated_cameras/sensor.hpp"

namespace atrium::simulated_cameras {

void declare(SimulatedCamerasConfig& config, config::OptionSet& set) {
    set.add("rig", config.rig, "rig.toml with the cameras of the simulated room");
    set.add("recording", config.recording, "folder of a recording to serve instead");
    set.add("write_recording",
            config.write_recording,
            "new folder; instead of serving what the cameras show, write it there as a recording");
    set.add("rate_hz",
            config.rate_hz,
            "pictures per second until a client sets another rate [Hz]; 0: the rig's",
            {0, 240});
    set.add("pixel_format",
            config.pixel_format,
            "pixel format of the sensors; a client that selects another one gets grey",
            pixel_format_names());
    set.add("empty_seconds",
            config.empty_seconds,
            "how long the room is empty after the first picture and after each SIGUSR1 [s]",
            {0, 1e6});
    set.add("seconds",
            config.seconds,
            "how long to serve [s]; 0: until the command ends or Ctrl-C; of a recording that is "
            "written: "
            "0 is 30 s",
            {0, 1e9});
    set.add("stamp",
            config.stamp,
            "write the camera and trigger numbers into the corner of each picture");
    set.add("list", config.list, "print the cameras and exit");
    set.add("own_network",
            config.own_network,
            "false: serve in the existing network, whose loopback must have the addresses");
    set.add("lose",
            config.faults.lose,
            "share of lost packets [%]: CAMERA=PERCENT,...; a camera is a name or a number");
    set.add("delay_ms", config.faults.delay_ms, "delay of pictures [ms]: CAMERA=MS,...");
    set.add("clock_offset_ms",
            config.faults.clock_offset_ms,
            "how far a camera's clock is ahead of the others [ms]: CAMERA=MS,...");
    set.add("stop",
            config.faults.stop,
            "switch a camera off for a while, in seconds after the first picture: "
            "CAMERA@FROM+SECONDS,...");
    set.add("restart", config.faults.restart, "switch a camera off and on again: CAMERA@FROM,...");
    set.add("seed", config.seed, "seed of lost packets");
    simulation::declare(config.simulation, set);
}

Expected<void> check(const SimulatedCamerasConfig& config) {
    if (config.rig.empty() && config.recording.empty()) {
        return make_error(ErrorKind::kConfiguration,
                          "rig, recording: one of them must be set, for example --rig "
                          "deploy/rigs/full_body.toml");
    }
    if (!config.rig.empty() && !config.recording.empty()) {
        return make_error(ErrorKind::kConfiguration,
                          "rig, recording: only one may be set; a recording has its own rig");
    }
    if (!config.recording.empty() && !config.write_recording.empty()) {
        return make_error(ErrorKind::kConfiguration,
                          "write_recording: writes what a simulated room shows: give --rig instead "
                          "of --recording");
    }
    return {};
}

}  // namespace atrium::simulated_cameras
