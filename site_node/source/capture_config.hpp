#pragma once

#include "core/config/option_set.hpp"
#include "core/config/table_reader.hpp"
#include "site_node/source/camera_config.hpp"

#include <filesystem>
#include <map>
#include <string>

namespace atrium::site_node {

/// Where pictures come from: `[capture]`.
struct CaptureConfig {
    std::string source = "simulated";  // or "recording", "cameras"
    std::filesystem::path rig;         // simulated, cameras: the rig file
    std::filesystem::path recording;   // recording: its folder
    double rate_hz = 0.0;              // 0: as recorded, or the rig's rate
    bool loop = false;                 // recording: start again at its end
    int every = 1;                     // recording: each Nth instant
    bool aligned = false;              // AlignedSource; software triggers count from the epoch
    bool as_fast_as_possible = false;  // recording: the next metaframe when the last one is done
    double tolerance_ms = 0.0;         // between a trigger and its pictures; 0: a quarter period
    double deadline_ms = 100.0;        // how long a metaframe may stay incomplete
    int min_cameras = 0;  // needed at the deadline to use an incomplete metaframe; 0: all
    CameraConfig cameras;
    /// Place in the file of the path of rig or recording, for errors: "capture.rig PATH" ->
    /// "site.toml:7". With the path, because the command line may override it.
    std::map<std::string, std::string> places;
};

/// Declares `capture.*` and `every`; `config` must outlive `set`.
void declare(CaptureConfig& config, config::OptionSet& set);

/// Remembers where the file names its rig and its recording.
void read_places(config::TableReader& reader, CaptureConfig& config);

/// Checks rules that span several options. Cameras may lack a rig.
Expected<void> check(const CaptureConfig& config);

/// Checks that the rig or the recording exists. Error kNotFound names the place in the file.
Expected<void> check_places(const CaptureConfig& config);

}  // namespace atrium::site_node
