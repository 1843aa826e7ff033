#include "tools/calibrate/sweep/sweep_options.hpp"

namespace atrium::calibrate {

void SweepOptions::add_to(CLI::App& command) {
    command.add_option("--recording", source.recording, "folder of a recording of the sweep")
        ->type_name("DIR")
        ->group(kPicturesGroup);
    command
        .add_option("--instants",
                    num_instants,
                    "instants that end a live sweep, if each camera saw half of them")
        ->check(CLI::Range(50, 100000))
        ->capture_default_str()
        ->group(kPicturesGroup);
    command
        .add_option("--keep-points",
                    keep_points,
                    "CSV to write the points into; default: beside the rig, with .points.csv")
        ->type_name("FILE")
        ->group(kPicturesGroup);
    command
        .add_option("--light-threshold",
                    light_threshold,
                    "grey levels above the background from which a pixel is part of a light; "
                    "default: by the noise of each picture")
        ->check(CLI::Range(1.0, 254.0))
        ->group(kPicturesGroup);
    source.add_to(command, "lights");
}

}  // namespace atrium::calibrate
