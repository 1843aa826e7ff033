#pragma once

#include "core/app/process.hpp"
#include "core/bus/bus.hpp"
#include "core/config/option_set.hpp"
#include "core/config/table_reader.hpp"
#include "simulation/room_config.hpp"
#include "site_node/hosts/site_hosts.hpp"
#include "site_node/pipeline.hpp"
#include "site_node/record_config.hpp"
#include "site_node/source/capture_config.hpp"
#include "site_node/stream/viewer_links.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace atrium::site_node {

struct SiteNodeConfig {
    std::string name = "site";
    int threads = 0;                // 0: all cores but one
    double seconds = 0.0;           // 0: until Ctrl-C or the end of the recording
    std::filesystem::path preview;  // preview::Preview's target; empty: none
    std::filesystem::path kept_silhouettes = ".cache/silhouettes";  // KeptSilhouettes; empty: none
    bool list_cameras = false;                                      // print the cameras and exit
    CaptureConfig capture;
    simulation::RoomConfig simulation;
    PipelineOptions pipeline;
    RecordConfig record;
    std::string settings;  // all options as text, for a recording
    stream::StreamOptions stream;
    /// "auto": adapts the stream, except on loopback, where no link can be slow.
    std::string stream_adapt = "auto";        // or "on", "off"
    std::string texture_resolution = "half";  // or "full"
    std::vector<hosts::HostEntry> hosts;  // with cameras of this site; empty: this process does all
    std::string host;                     // this one's name in `hosts`; empty: that of the system
    bus::BusOptions bus;
    app::ProcessOptions process;

    // modes that replace a normal run
    bool learn_background = false;            // learn the empty room, keep it, exit
    std::filesystem::path write_silhouettes;  // segment a recording into this folder, exit
    bool overwrite = false;                   // write_silhouettes may use a non-empty folder
    std::filesystem::path recording;          // shorthand: source "recording" with this folder
    double rate_hz = kAsConfigured;           // shorthand: capture.rate_hz; 0: as fast as possible
    static constexpr double kAsConfigured = -1.0;
};

/// Declares every option with its default; `config` must outlive `set`.
void declare(SiteNodeConfig& config, config::OptionSet& set);

/// Reads the bounds and lists of `[hull]`, which are not options. `reader` collects the errors.
void read_hull(config::TableReader& reader, SiteNodeConfig& config);

/// Reads all tables and lists that are not options. `reader` collects the errors.
void read_tables(config::TableReader& reader, SiteNodeConfig& config);

/// The site file at `path` as it is written: nothing resolved, no rule across options checked.
Expected<SiteNodeConfig> load_site_file(const std::filesystem::path& path);

/// The name of this host among `[[host]]`.
std::string own_host(const SiteNodeConfig& config);

/// hosts::check_hosts for this configuration.
Expected<void> check_hosts(const SiteNodeConfig& config, const config::Rig& rig);

/// Of the rig and all options on which the hulls of regions depend: hosts that differ in it must
/// not compute for each other.
std::uint64_t hull_settings(const SiteNodeConfig& config, const config::Rig& rig);

/// The number of threads that `threads = 0` stands for: all cores but one, at least one.
int default_threads();

/// Applies shorthand options and derives `stream.adapt`, the texture resolution and the number of
/// threads.
void resolve(SiteNodeConfig& config);

/// Checks rules that span several options.
Expected<void> check(const SiteNodeConfig& config);

}  // namespace atrium::site_node
