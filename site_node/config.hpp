#pragma once

#include "core/app/process.hpp"
#include "core/bus/bus.hpp"
#include "core/config/option_set.hpp"
#include "core/config/table_reader.hpp"
#include "simulation/room_config.hpp"
#include "site_node/camera_config.hpp"
#include "site_node/pipeline.hpp"
#include "site_node/stream/viewer_links.hpp"

#include <filesystem>
#include <string>

namespace atrium::site_node {

struct CaptureConfig {
    std::string source = "simulated";  // or "recording", "cameras"
    std::filesystem::path rig;         // simulated, cameras: the room's
    std::filesystem::path recording;   // recording: its folder
    double rate_hz = 0.0;              // 0: as recorded, or the rig's rate
    bool loop = false;                 // recording: start again at its end
    double tolerance_ms = 0.0;         // between a trigger and its pictures; 0: a quarter period
    double deadline_ms = 100.0;        // how long a metaframe may stay incomplete
    int min_cameras = 0;               // with so many it is used all the same then; 0: all
    CameraConfig cameras;
};

struct SiteNodeConfig {
    std::string name = "site";
    int threads = 1;
    double seconds = 0.0;           // 0: until Ctrl-C or the end of the recording
    std::filesystem::path preview;  // preview::Preview's target; empty: none
    bool list_cameras = false;      // and do nothing else
    CaptureConfig capture;
    simulation::RoomConfig simulation;
    PipelineOptions pipeline;
    stream::StreamOptions stream;
    /// "auto": `stream.adapt` but on loopback, where no network is that could be narrow.
    std::string stream_adapt = "auto";        // or "on", "off"
    std::string texture_resolution = "half";  // or "full"
    bus::BusOptions bus;
    app::ProcessOptions process;

    // what to do instead of running
    bool learn_background = false;            // learn the empty room, keep it, end
    std::filesystem::path write_silhouettes;  // segment a recording into this folder, end
    bool overwrite = false;                   // also where that folder holds something
    std::filesystem::path recording;          // short for a source "recording" with this folder
};

/// Declares every option with its default; `config` must outlive `set`.
void declare(SiteNodeConfig& config, config::OptionSet& set);

/// What is no option: bounds and lists of `[hull]`. Problems are kept by `reader`.
void read_hull(config::TableReader& reader, SiteNodeConfig& config);

/// What is no option: areas of `[[segmentation.camera]]`. Problems are kept by `reader`.
void read_segmentation(config::TableReader& reader, SiteNodeConfig& config);

/// Puts what was given in short where it belongs.
void resolve(SiteNodeConfig& config);

/// Areas are of cameras of this rig.
Expected<void> check_areas(const SiteNodeConfig& config, const config::Rig& rig);

/// What options cannot check one by one.
Expected<void> check(const SiteNodeConfig& config);

}  // namespace atrium::site_node
