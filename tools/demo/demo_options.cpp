#include "core/bus/limits.hpp"
#include "tools/demo/demo.hpp"

namespace atrium::demo {

void declare(DemoConfig& config, config::OptionSet& options) {
    options.add(
        "seconds", config.seconds, "length of the measured part [s]; 0: until Ctrl-C", {0, 1e6});
    options.add("startup-seconds",
                config.startup_seconds,
                "time limit until everybody is on [s]",
                {1, 1e5});
    options.add("table-seconds",
                config.table_seconds,
                "time between two tables where the output is no terminal [s]",
                {1, 1e5});
    options.add("reset-seconds",
                config.reset_seconds,
                "period of resetting the world's objects [s]; 0: never",
                {0, 1e6});
    options.add("window", config.window, "open a window", {"auto", "yes", "no"});
    options.add("output",
                config.output,
                "folder for picture, video, report and logs of the last demo that succeeded");
    options.add("programs",
                config.programs,
                "folder of site_node, world_server and viewer; empty: folder of this program");
    options.add("deploy", config.deploy, "folder that holds sites/NAME.toml");
    options.add("sites", config.sites, "names of the sites, separated by commas");
    options.add("motions",
                config.motions,
                "motions of the people at the sites, in the same order, separated by commas "
                "(simulation.motion of site_node); empty: from the site files");
    options.add("world", config.world, "world description");
    options.add("viewer", config.viewer, "viewer configuration");
    options.add("camera",
                config.camera,
                "position of the viewer's eye, \"x,y,z\" in the world [m]; empty: from its file");
    options.add("target",
                config.target,
                "point that the eye looks at, \"x,y,z\" in the world [m]; empty: from its file");
    options.add("fov-deg",
                config.fov_deg,
                "vertical angle of view [deg]; 0: from the viewer file",
                {0, 120});
    options.add("site-nice",
                config.site_nice,
                "process.nice of the sites: -20 highest priority, 19 lowest",
                {-20, 19});
    options.add("world-nice", config.world_nice, "process.nice of the world server", {-20, 19});
    options.add("viewer-nice", config.viewer_nice, "process.nice of the viewer", {-20, 19});
    options.add("domain", config.domain, "DDS domain", {0, bus::kMaxDomain});
    options.add("secured",
                config.secured,
                "encrypt everything, and let only these programs in: with keys that are made for "
                "this run (atrium keys) and removed at its end");
}

}  // namespace atrium::demo
