#pragma once

#include "core/base/expected.hpp"
#include "core/config/option_set.hpp"
#include "simulation/room_config.hpp"
#include "site_node/source/capture_config.hpp"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <map>
#include <string>

namespace atrium::calibrate {

/// Where the pictures of a sweep come from, and when it is enough: options of `calibrate wand`.
struct SweepOptions {
    std::filesystem::path recording;    // shorthand for capture.source and capture.recording
    std::filesystem::path config;       // a site's file
    site_node::CaptureConfig capture;   // once `resolve` has read the file and the command line
    simulation::RoomConfig room;        // likewise
    std::size_t num_instants = 300;     // after which a live sweep ends
    std::filesystem::path keep_points;  // empty: beside the rig
    std::filesystem::path preview;      // empty: none
    double light_threshold = 0.0;       // DetectionOptions

    SweepOptions();
    SweepOptions(const SweepOptions&) = delete;
    SweepOptions& operator=(const SweepOptions&) = delete;

    /// Adds all of them to the command line; `*this` must outlive it.
    void add_to(CLI::App& command);

    /// True if the command line names a source of pictures.
    bool is_asked() const;

    /// Reads the file, then what the command line overrides, and checks both.
    Expected<void> resolve();

private:
    config::OptionSet set_;                     // [capture] and [simulation], as of site_node
    std::map<std::string, std::string> given_;  // on the command line, by key
};

}  // namespace atrium::calibrate
