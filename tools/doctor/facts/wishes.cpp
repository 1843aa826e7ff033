#include "core/config/rig.hpp"
#include "core/config/table_reader.hpp"
#include "tools/doctor/facts/collect.hpp"

#include <algorithm>

namespace atrium::doctor {
namespace {

// Of the sensor; other formats are converted in the camera.
double bytes_per_pixel(const std::string& format) {
    if (format == "RGB8" || format == "BGR8") return 3.0;
    if (format.rfind("YUV422", 0) == 0) return 2.0;
    return 1.0;
}

void read_bus(config::TableReader& file, Wishes& wishes) {
    std::string network;
    file.read("bus.network", network);
    // a file of its own is as LAN: only loopback and the others differ in what they need
    if (!network.empty()) wishes.network = network;
    std::string peers;
    file.read("bus.peers", peers);
    wishes.has_peers = !peers.empty();
    file.read("bus.interface", wishes.interface);
    file.read("bus.domain", wishes.domain, {0, 230});
    std::string keys;
    file.read("bus.security", keys);
    if (!keys.empty() && keys != "none") file.read("bus.security", wishes.keys);
    file.read("bus.join", wishes.keys);
    file.read("process.nice", wishes.nice, {-20, 19});
}

// One `[[host]]`. The programs check the rest of its rules.
struct HostTable {
    std::string name;
    std::vector<std::string> cameras;
    bool takes_any = false;  // cameras = "auto": those that no other host names
    bool is_model = false;
    std::vector<std::string> regions;
};

std::vector<HostTable> read_host_tables(config::TableReader& file) {
    std::vector<HostTable> tables;
    for (config::TableReader& entry : file.tables("host")) {
        HostTable host;
        entry.read("name", host.name);
        if (entry.has_array("cameras")) {
            entry.read("cameras", host.cameras);
        } else {
            std::string which = entry.has("cameras") ? "" : "none";
            entry.read("cameras", which);
            host.takes_any = which == "auto";
            if (!host.takes_any && which != "none")
                entry.reject("cameras",
                             "must be \"auto\" or a list of cameras of the rig, as in [\"door\"]");
        }
        entry.read("model", host.is_model);
        entry.read("regions", host.regions);
        entry.pass_over_others();
        tables.push_back(std::move(host));
    }
    return tables;
}

const HostTable* table_of(const std::vector<HostTable>& tables, const std::string& host) {
    if (host.empty()) return nullptr;
    const auto own = std::ranges::find(tables, host, &HostTable::name);
    return own == tables.end() ? nullptr : &*own;
}

SiteHosts hosts_seen_from(const std::string& host, const std::vector<HostTable>& tables) {
    SiteHosts hosts;
    hosts.own = host;
    for (const HostTable& table : tables) hosts.names.push_back(table.name);
    const HostTable* own = table_of(tables, host);
    if (own == nullptr) return hosts;
    hosts.is_listed = true;
    hosts.has_cameras = own->takes_any || !own->cameras.empty();
    hosts.is_model = own->is_model;
    hosts.has_regions = !own->regions.empty();
    return hosts;
}

bool names_camera(const HostTable& host, const std::string& camera) {
    return std::ranges::find(host.cameras, camera) != host.cameras.end();
}

// Leaves only what this host does, of a site on several hosts.
void keep_own_part(Wishes& wishes, const std::vector<HostTable>& tables) {
    if (tables.empty()) return;
    const HostTable* own = table_of(tables, wishes.hosts.own);
    std::erase_if(wishes.cameras, [&](const SiteCamera& camera) {
        if (own == nullptr) return true;
        if (!own->takes_any) return !names_camera(*own, camera.name);
        return std::ranges::any_of(
            tables, [&](const HostTable& host) { return names_camera(host, camera.name); });
    });
    if (!wishes.hosts.is_model) wishes.cache.clear();
}

// Sizes are those of the rig; a camera that it does not have counts nothing.
void read_rig(Wishes& wishes) {
    const auto rig = config::load_rig(wishes.rig);
    if (!rig) {
        wishes.rig_problem = rig.error().message;
        return;
    }
    if (wishes.rate_hz <= 0.0) wishes.rate_hz = rig->rate_hz;
    if (wishes.cameras.empty()) wishes.cameras.resize(rig->cameras.size());
    for (std::size_t i = 0; i < wishes.cameras.size(); ++i) {
        SiteCamera& wanted = wishes.cameras[i];
        for (std::size_t j = 0; j < rig->cameras.size(); ++j) {
            const auto& camera = rig->cameras[j];
            const bool is_named = !wanted.name.empty();
            if (is_named ? camera.name != wanted.name : i != j) continue;
            wanted.name = camera.name;
            wanted.megapixels =
                1e-6 * camera.intrinsics.width * static_cast<double>(camera.intrinsics.height);
        }
    }
}

void read_capture(config::TableReader& file, Wishes& wishes) {
    wishes.source = "simulated";
    file.read("site.kept_silhouettes", wishes.cache);
    config::TableReader capture = file.table("capture");
    capture.read("source", wishes.source, {"simulated", "recording", "cameras"});
    capture.read("rig", wishes.rig);
    capture.read("recording", wishes.recording);
    capture.read("rate_hz", wishes.rate_hz, {0, 1000});
    std::string format;
    capture.read("cameras.pixel_format", format);
    for (config::TableReader& entry : capture.tables("camera")) {
        SiteCamera camera;
        entry.read("name", camera.name);
        entry.read("serial", camera.serial);
        entry.read("address", camera.address);
        std::string own = format;
        entry.read("pixel_format", own);
        camera.bytes_per_pixel = bytes_per_pixel(own);
        entry.pass_over_others();
        wishes.cameras.push_back(std::move(camera));
    }
    if (wishes.source == "recording") {
        if (wishes.recording.empty()) return;  // the command line of the site will name it
        std::error_code error;
        wishes.is_recording_there = std::filesystem::is_directory(wishes.recording, error);
        wishes.rig = wishes.recording;
    }
    if (wishes.is_recording_there) read_rig(wishes);
}

// For a host that the file does not name, the part of its first one: any of them shows what is
// wrong in the file.
std::vector<Wishes::Reader> readers_of_site(const SiteHosts& own,
                                            const std::vector<HostTable>& tables) {
    if (tables.empty()) return {{"site_node", ""}};
    const SiteHosts hosts = own.is_listed ? own : hosts_seen_from(tables.front().name, tables);
    std::vector<Wishes::Reader> readers;
    if (hosts.has_cameras) readers.push_back({"camera_node", hosts.own});
    if (hosts.runs_site_node() || !hosts.has_cameras) readers.push_back({"site_node", hosts.own});
    return readers;
}

void read_site(config::TableReader& file, const std::string& own_host, Wishes& wishes) {
    const std::vector<HostTable> tables = read_host_tables(file);
    wishes.hosts = hosts_seen_from(own_host, tables);
    wishes.readers = readers_of_site(wishes.hosts, tables);
    read_capture(file, wishes);
    keep_own_part(wishes, tables);
}

}  // namespace

Expected<Roles> roles_of_file(const std::filesystem::path& file, const std::string& own_host) {
    auto reader = config::TableReader::load(file);
    if (!reader) return tl::unexpected(reader.error());
    Roles roles;
    roles.viewer = reader->has("view") || reader->has("display");
    roles.site = !roles.viewer && (reader->has("capture") || reader->has("site")) &&
                 !reader->has_array("site");
    roles.world = !roles.viewer && !roles.site;
    std::string source;
    if (!roles.site) return roles;
    reader->read("capture.source", source);
    const SiteHosts hosts = hosts_seen_from(own_host, read_host_tables(*reader));
    roles.camera = source == "cameras" && (hosts.names.empty() || hosts.has_cameras);
    return roles;
}

Expected<Wishes> read_wishes(const std::filesystem::path& file, const std::string& own_host) {
    auto reader = config::TableReader::load(file);
    if (!reader) return tl::unexpected(reader.error());
    const auto roles = roles_of_file(file, own_host);
    if (!roles) return tl::unexpected(roles.error());
    Wishes wishes;
    wishes.file = file;
    wishes.network = "loopback";  // as the programs, without the key
    read_bus(*reader, wishes);
    if (roles->site)
        read_site(*reader, own_host, wishes);
    else
        wishes.readers = {{roles->viewer ? "viewer" : "world_server", ""}};
    // the programs read the rest and know its rules; a world has other tables of these names
    std::vector<std::string> tables{"bus", "process"};
    if (roles->site) tables.insert(tables.end(), {"site", "capture", "capture.cameras"});
    for (const std::string& table : tables) reader->table(table).pass_over_others();
    reader->pass_over_others();
    if (auto read = reader->finish(); !read) return tl::unexpected(read.error());
    return wishes;
}

}  // namespace atrium::doctor
