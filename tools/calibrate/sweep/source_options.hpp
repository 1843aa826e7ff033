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

/// Where the pictures of cameras come from that are not calibrated yet, and where they are shown:
/// options of the subcommands that watch cameras.
struct SourceOptions {
    std::filesystem::path config;      // a site's file
    std::filesystem::path recording;   // shorthand for capture.source and capture.recording
    site_node::CaptureConfig capture;  // once `resolve` has read the file and the command line
    simulation::RoomConfig room;       // likewise
    std::filesystem::path preview;     // empty: none

    SourceOptions();
    SourceOptions(const SourceOptions&) = delete;
    SourceOptions& operator=(const SourceOptions&) = delete;

    /// Adds all but `recording` to the command line; `*this` must outlive it. `shown`: what the
    /// preview shows, "lights".
    void add_to(CLI::App& command, const std::string& shown);

    /// True if the command line names a source of pictures.
    bool is_asked() const;

    /// Reads the file, then what the command line overrides, and checks both.
    Expected<void> resolve();

private:
    config::OptionSet set_;                     // [capture] and [simulation], as of site_node
    std::map<std::string, std::string> given_;  // on the command line, by key
};

/// The group of these options in the help.
inline constexpr const char* kPicturesGroup = "Pictures of cameras";

}  // namespace atrium::calibrate
