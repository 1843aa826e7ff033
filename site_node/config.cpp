#include "site_node/config.hpp"

#include "core/base/fnv1a.hpp"
#include "core/bus/bus_options.hpp"
#include "core/config/rig.hpp"
#include "core/presence/membership.hpp"
#include "site_node/preview/preview.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <thread>
#include <utility>

namespace atrium::site_node {
namespace {

constexpr config::Range kPosition{-1e4, 1e4};  // [m], as in rigs

// A box of this many metres holds at least a hand.
constexpr double kMinExtent_m = 0.01;

constexpr int kMaxThreads = 64;

geometry::Aabb read_bounds(config::TableReader& owner) {
    config::TableReader table = owner.table("bounds");
    geometry::Aabb box{Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones()};
    table.require("min");
    table.require("max");
    table.read("min", box.min.data(), 3, kPosition);
    table.read("max", box.max.data(), 3, kPosition);
    if (!(box.size().array() >= kMinExtent_m).all()) {
        table.reject("max",
                     fmt::format("must be larger than min by {} m in x, y and z", kMinExtent_m));
    }
    return box;
}

// Modes that replace a normal run.
void declare_modes(SiteNodeConfig& config, config::OptionSet& set) {
    set.add("learn-background",
            config.learn_background,
            "learn the empty room, write it to segmentation.background_folder, and exit");
    set.add(
        "recording", config.recording, "shorthand for capture.source = recording with this folder");
    set.add(
        "rate",
        config.rate_hz,
        "shorthand for capture.rate_hz [Hz]; of a recording 0: each metaframe as soon as the one "
        "before is done, none is dropped; -1: as capture.rate_hz says",
        {SiteNodeConfig::kAsConfigured, 1000});
    set.add(
        "write-silhouettes",
        config.write_silhouettes,
        "segment each metaframe of the recording once, write masks and polygons here, and exit");
    set.add("overwrite", config.overwrite, "let --write-silhouettes write into a non-empty folder");
}

void declare_stream(SiteNodeConfig& config, config::OptionSet& set) {
    stream::StreamOptions& stream = config.stream;
    set.add("stream.max_mbit_per_s",
            stream.max_mbit_per_s,
            "upper limit for meshes and textures [Mbit/s]; 0: no limit",
            {0, 1e5});
    set.add("stream.min_mbit_per_s",
            stream.min_mbit_per_s,
            "no viewer's link lowers the stream below this [Mbit/s]",
            {0.1, 1e5});
    set.add(
        "stream.adapt",
        config.stream_adapt,
        "adapt to the links of the viewers: lower quality, then resolution, then rate; auto: on, "
        "except on loopback",
        {"auto", "on", "off"});
}

RegionOptions read_region(config::TableReader& table) {
    RegionOptions region;
    table.require("name");
    table.read("name", region.name);
    if (!config::is_valid_name(region.name))
        table.reject("name", "must be 1 to 63 characters of A-Z a-z 0-9 _ . -");
    table.require("bounds");
    region.bounds = read_bounds(table);
    table.read("cameras", region.cameras);
    return region;
}

std::string text_of(const geometry::Aabb& box) {
    return fmt::format("[{}, {}, {}] to [{}, {}, {}]",
                       box.min.x(),
                       box.min.y(),
                       box.min.z(),
                       box.max.x(),
                       box.max.y(),
                       box.max.z());
}

// "X0,Y0,Z0,X1,Y1,Z1"
bool parse_bounds(const std::string& text, std::optional<geometry::Aabb>& bounds) {
    auto reader = config::TableReader::parse("value = [" + text + "]", "");
    std::array<double, 6> v{};
    if (!reader) return false;
    reader->read("value", v.data(), v.size(), kPosition);
    const geometry::Aabb box{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
    if (!reader->finish() || !(box.size().array() >= kMinExtent_m).all()) return false;
    bounds = box;
    return true;
}

void declare_hull(HullStageOptions& hull, config::OptionSet& set) {
    set.add_own(
        "hull.bounds",
        "X0,Y0,Z0,X1,Y1,Z1",
        "the hull is cut at this box: lowest and highest corner, site frame [m]; else at "
        "[bounds] of the rig, if it has them",
        [&hull](const std::string& text) { return parse_bounds(text, hull.bounds); },
        [&hull] { return hull.bounds ? text_of(*hull.bounds) : "none"; });
    set.add("hull.min_views",
            hull.min_views,
            "a point seen by fewer cameras is not in the hull; 0: off",
            {0, 64});
    set.add("hull.refine",
            hull.refine,
            "of the hull: photo: move it inwards to where the pictures agree; round: round its "
            "corners, where it lies outside of every smooth body with the same silhouettes; "
            "round_photo: first round, then photo; off: leave it exact",
            {"photo", "round", "round_photo", "off"});
    set.add("hull.pause_refinement",
            hull.pause_refinement,
            "the refinement by pictures pauses while the host is too slow for it");
    set.add("hull.min_component_l",
            hull.min_component_l,
            "components smaller than this are dropped, unless phantoms are kept [l]",
            {0, 1000});
    set.add("hull.find_camouflaged",
            hull.find_camouflaged,
            "parts of people that look like the empty room in one camera are found by the others; "
            "needs bounds and six cameras");
    set.add("hull.keep_phantoms", hull.keep_phantoms, "keep components that no silhouette needs");
    set.add("hull.partial_views",
            hull.partial_views,
            "true: people may extend beyond the pictures, and space outside them is unknown; needs "
            "bounds");
}

std::string text_of(const std::vector<hosts::HostEntry>& hosts) {
    std::string text;
    for (const hosts::HostEntry& host : hosts) {
        text +=
            fmt::format("{}{}{} cameras [{}]",
                        text.empty() ? "" : ", ",
                        host.name,
                        host.is_model ? " with the model" : "",
                        host.takes_any ? "auto" : fmt::format("{}", fmt::join(host.cameras, ", ")));
        if (!host.regions.empty())
            text += fmt::format(" regions [{}]", fmt::join(host.regions, ", "));
    }
    return text.empty() ? "none" : text;
}

// Shows the values that only read_hull reads.
void show_hull(const HullStageOptions& hull, config::OptionSet& set) {
    set.show("hull.whole_cameras",
             [&hull] { return fmt::format("[{}]", fmt::join(hull.whole_cameras, ", ")); });
    set.show("hull.region", [&hull] {
        std::string text;
        for (const RegionOptions& region : hull.regions) {
            text += fmt::format("{}{} {} cameras [{}]",
                                text.empty() ? "" : ", ",
                                region.name,
                                text_of(region.bounds),
                                fmt::join(region.cameras, ", "));
        }
        return text.empty() ? "none" : text;
    });
}

}  // namespace

void declare(SiteNodeConfig& config, config::OptionSet& set) {
    set.add("site.name", config.name, "name of this site in its world; A-Z a-z 0-9 _ . - only");
    set.add("site.threads",
            config.threads,
            "worker threads for segmentation and hull; 0: all cores but one",
            {0, kMaxThreads});
    set.add("site.seconds",
            config.seconds,
            "how long to run [s]; 0: until Ctrl-C or the end of a recording",
            {0, 1e9});

    set.add("site.kept_silhouettes",
            config.kept_silhouettes,
            "while a camera contradicts the rig, a folder here with the site's name has the newest "
            "silhouettes, for `calibrate refine`; empty: none");

    set.add(
        "site.host",
        config.host,
        "of a site on several hosts, [[host]]: the name of this one; empty: that of the system");
    set.add_alias("host");

    set.add(
        "preview",
        config.preview,
        "show all views with their silhouettes, in a PNG written once a second or in a \"window\"; "
        "without a value: a window, or preview.png if there is no display",
        preview::kWindow);

    declare(config.capture, set);
    set.add("list-cameras", config.list_cameras, "print the connected cameras and exit");

    simulation::declare(config.simulation, set);

    declare(static_cast<SilhouetteStageOptions&>(config.pipeline), set);
    declare_modes(config, set);

    declare_hull(config.pipeline.hull, set);
    set.add("codec.position_bits",
            config.pipeline.mesh.position_bits,
            "bits of a vertex coordinate on the wire, 8 to 20; 0: as precise as the cameras see",
            {0, 20});
    set.add("codec.mesh_speed",
            config.pipeline.mesh.speed,
            "Draco's speed, 0 smallest to 10 fastest",
            {0, 10});
    set.add("codec.jpeg_quality",
            config.pipeline.jpeg_quality,
            "JPEG quality of the textures",
            {10, 100});
    set.add("codec.texture_resolution",
            config.texture_resolution,
            "texture resolution relative to the camera pictures; full: sharper, but more bytes",
            {"half", "full"});
    declare_stream(config, set);
    declare(config.record, set);
    bus::declare(config.bus, set);
    app::declare(config.process, set);
    show_hull(config.pipeline.hull, set);
    set.show("host", [&config] { return text_of(config.hosts); });
}

void read_hull(config::TableReader& reader, SiteNodeConfig& config) {
    config::TableReader table = reader.table("hull");
    HullStageOptions& hull = config.pipeline.hull;
    if (table.has("bounds")) hull.bounds = read_bounds(table);
    table.read("whole_cameras", hull.whole_cameras);
    const auto keep_place = [&](config::TableReader& owner,
                                const std::string& prefix,
                                const std::string& key,
                                const std::string& value = "") {
        if (owner.has(key)) hull.places[prefix + key + value] = owner.where(key);
    };
    keep_place(table, "hull.", "bounds");
    keep_place(table, "hull.", "whole_cameras");
    keep_place(table, "hull.", "min_views", fmt::format(" = {}", hull.min_views));
    keep_place(table, "hull.", "partial_views", fmt::format(" = {}", hull.partial_views));
    std::set<std::string> names;
    for (config::TableReader& region : table.tables("region")) {
        const std::string prefix = fmt::format("hull.region[{}].", hull.regions.size());
        hull.regions.push_back(read_region(region));
        keep_place(region, prefix, "bounds");
        keep_place(region, prefix, "cameras");
        if (!names.insert(hull.regions.back().name).second)
            region.reject("name", "must be different for every region");
    }
}

void read_tables(config::TableReader& reader, SiteNodeConfig& config) {
    read_hull(reader, config);
    read_segmentation(reader, config.pipeline);
    read_cameras(reader, config.capture.cameras);
    read_places(reader, config.capture);
    hosts::read_hosts(reader, config.hosts);
}

Expected<SiteNodeConfig> load_site_file(const std::filesystem::path& path) {
    SiteNodeConfig config;
    config::OptionSet set;
    declare(config, set);
    auto reader = config::TableReader::load(path);
    if (!reader) return tl::unexpected(reader.error());
    set.read_file(*reader);
    read_tables(*reader, config);
    if (auto done = reader->finish(); !done) return tl::unexpected(done.error());
    return config;
}

std::string own_host(const SiteNodeConfig& config) {
    return config.host.empty() ? presence::host_name() : config.host;
}

Expected<void> check_hosts(const SiteNodeConfig& config, const config::Rig& rig) {
    std::vector<std::string> regions;
    for (const RegionOptions& region : config.pipeline.hull.regions) regions.push_back(region.name);
    // recordings and simulated rooms have all cameras everywhere
    if (const auto sharing = hosts::hosts_that_share(config.hosts);
        !sharing.empty() && config.capture.source != "cameras")
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("host: {} have cameras = \"auto\", but source = \"{}\" has all cameras on "
                        "each host: name the cameras of each",
                        fmt::join(sharing, " and "),
                        config.capture.source));
    return hosts::check_hosts(config.hosts, rig, regions, config.name);
}

std::uint64_t hull_settings(const SiteNodeConfig& config, const config::Rig& rig) {
    Fnv1a hash;
    hash.add(config::fingerprint(rig));
    hash.add(fingerprint(config.pipeline.hull));
    hash.add_rounded(config.pipeline.silhouette.tolerance_px);
    return hash.value();
}

int default_threads() {
    return std::clamp(static_cast<int>(std::thread::hardware_concurrency()) - 1, 1, kMaxThreads);
}

void resolve(SiteNodeConfig& config) {
    if (config.threads == 0) config.threads = default_threads();
    if (config.texture_resolution == "full")
        config.pipeline.texture.resolution = texture::Resolution::kFull;
    config.stream.adapt = config.stream_adapt == "on" ||
                          (config.stream_adapt == "auto" && config.bus.network != "loopback");
    if (config.rate_hz > 0.0) config.capture.rate_hz = config.rate_hz;
    config.capture.as_fast_as_possible = config.rate_hz == 0.0;
    if (config.recording.empty()) return;
    config.capture.source = "recording";
    config.capture.recording = config.recording;
}

Expected<void> check(const SiteNodeConfig& config) {
    const auto wrong = [](std::string text) {
        return make_error(ErrorKind::kConfiguration, std::move(text));
    };
    if (!config::is_valid_name(config.name)) {
        return wrong(fmt::format(
            "site.name: must be 1 to 63 characters of A-Z a-z 0-9 _ . -, got '{}'", config.name));
    }
    if (!config.host.empty() && config.hosts.empty())
        return wrong(
            "--host, site.host: the site's file has no [[host]]: the site is one process, on this "
            "host (docs/site_hosts.md)");
    if (auto checked = check(config.capture); !checked) return checked;
    if ((config.capture.aligned || !config.hosts.empty()) &&
        (config.capture.every > 1 || config.capture.as_fast_as_possible)) {
        return wrong(
            "--every, --rate 0: a site on several hosts, and capture.aligned, play each instant at "
            "its time");
    }
    if (config.capture.source == "cameras") {
        if (config.capture.rig.empty())
            return wrong("capture.rig: must be set for cameras: their calibration");
        if (auto checked = check(config.capture.cameras); !checked) return checked;
    }
    if (!config.record.folder.empty() && !config.hosts.empty()) {
        return wrong(
            "--record: a site on several hosts is not recorded: each host has the pictures of its "
            "own cameras only");
    }
    if (needs_pictures(config.pipeline.hull) && !config.hosts.empty()) {
        return wrong(
            fmt::format("hull.refine: a site on several hosts cannot use {}: the hulls are "
                        "computed without the pictures, which stay on the hosts of the cameras; "
                        "use round or off",
                        config.pipeline.hull.refine));
    }
    if (config.capture.min_cameras == 1) {
        return wrong(
            "capture.min_cameras: must be 0 (all) or at least 2: a hull needs more than one "
            "camera");
    }
    const int bits = config.pipeline.mesh.position_bits;
    if (bits > 0 && bits < 8) {
        return wrong(fmt::format(
            "codec.position_bits: must be 0 (as precise as the cameras see) or 8 to 20, got {}",
            bits));
    }
    return check(config.pipeline.hull);
}

}  // namespace atrium::site_node
