#pragma once

#include "core/base/expected.hpp"
#include "core/config/option_set.hpp"

#include <filesystem>
#include <stop_token>
#include <string>

namespace atrium::demo {

struct DemoConfig {
    /// Length of the measured part, from the first picture with everybody on; 0: until Ctrl-C.
    double seconds = 20.0;
    double startup_seconds = 300;  // time limit for rendering the rooms and showing everybody
    /// Period of resetting the world's objects, which leaves something to push; 0: never.
    double reset_seconds = 12.0;
    double table_seconds = 10;    // between two tables where the output is no terminal
    std::string window = "auto";  // auto: if there is a display; yes; no
    std::filesystem::path output = "out/demo";
    std::filesystem::path
        programs;  // folder of site_node, world_server and viewer; empty: folder of this program
    std::filesystem::path deploy =
        "deploy";  // relative to the root of the repository, like `world` and `viewer`
    std::string sites = "alice,bob";  // names of files deploy/sites/NAME.toml
    std::string motions;  // motion at each site, in the same order; empty: from the site files
    std::filesystem::path world = "deploy/worlds/demo.toml";
    std::filesystem::path viewer = "deploy/viewer.toml";
    std::string camera, target;  // "x,y,z" in the world [m]; empty: from the viewer file
    double fov_deg = 0.0;        // vertical; 0: from the viewer file
    int site_nice = 0;           // process.nice of each program
    int world_nice = 0;
    int viewer_nice = 2;
    std::uint64_t domain = 0;
    bool secured = false;  // with keys that are made for this run
};

void declare(DemoConfig& config, config::OptionSet& options);

/// Starts the programs, shows the table, stops the programs, and leaves view.png, view.avi,
/// report.json and the logs in `output`. If it fails, `output` keeps what an earlier demo left, and
/// `output`/failed has the files of this one.
Expected<void> run_demo(const DemoConfig& config, std::stop_token stop);

}  // namespace atrium::demo
