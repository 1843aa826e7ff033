#pragma once

#include "core/base/expected.hpp"
#include "core/config/option_set.hpp"

#include <filesystem>
#include <stop_token>
#include <string>

namespace atrium::demo {

struct DemoConfig {
    double seconds = 20.0;  // measured, from the first picture with everybody on; 0: until Ctrl-C
    double startup_seconds =
        300;  // how long the rooms may take to be rendered and everybody to appear
    double reset_seconds = 12.0;  // the world's objects are put back this often, so that there is
                                  // something to push; 0: never
    std::string window = "auto";  // auto: where a display is; yes; no
    std::filesystem::path output = "out/demo";
    std::filesystem::path
        programs;  // folder of site_node, world_server and viewer; empty: this program's own
    std::filesystem::path deploy =
        "deploy";                     // like the next two, relative to the repository's root
    std::string sites = "alice,bob";  // deploy/sites/NAME.toml each
    std::string motions;  // what they do there, in that order; empty: as their files say
    std::filesystem::path world = "deploy/worlds/demo.toml";
    std::filesystem::path viewer = "deploy/viewer.toml";
    std::string camera, target;  // "x,y,z" in the world [m]; empty: as the viewer's file says
    double fov_deg = 0.0;        // vertical; 0: likewise
    int site_nice = 0;           // process.nice of each program, as its own default
    int world_nice = 0;
    int viewer_nice = 2;
    std::uint64_t domain = 0;
};

void declare(DemoConfig& config, config::OptionSet& options);

/// Starts the programs, shows the table, stops them, leaves view.png, view.avi and report.json in
/// `output`.
Expected<void> run_demo(const DemoConfig& config, std::stop_token stop);

}  // namespace atrium::demo
