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
    file.read("process.nice", wishes.nice, {-20, 19});
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
            wanted.megapixels =
                1e-6 * camera.intrinsics.width * static_cast<double>(camera.intrinsics.height);
        }
    }
}

void read_capture(config::TableReader& file, Wishes& wishes) {
    wishes.source = "simulated";
    wishes.cache = ".cache/silhouettes";
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

}  // namespace

Expected<Roles> roles_of_file(const std::filesystem::path& file) {
    auto reader = config::TableReader::load(file);
    if (!reader) return tl::unexpected(reader.error());
    Roles roles;
    roles.viewer = reader->has("view") || reader->has("display");
    roles.site = !roles.viewer && (reader->has("capture") || reader->has("site")) &&
                 !reader->has_array("site");
    roles.world = !roles.viewer && !roles.site;
    std::string source;
    if (roles.site) reader->read("capture.source", source);
    roles.camera = source == "cameras";
    return roles;
}

Expected<Wishes> read_wishes(const std::filesystem::path& file) {
    auto reader = config::TableReader::load(file);
    if (!reader) return tl::unexpected(reader.error());
    const auto roles = roles_of_file(file);
    if (!roles) return tl::unexpected(roles.error());
    Wishes wishes;
    wishes.file = file;
    wishes.network = "loopback";  // as the programs, without the key
    read_bus(*reader, wishes);
    if (roles->site) read_capture(*reader, wishes);
    // the programs read the rest and know its rules; a world has other tables of these names
    std::vector<std::string> tables{"bus", "process"};
    if (roles->site) tables.insert(tables.end(), {"site", "capture", "capture.cameras"});
    for (const std::string& table : tables) reader->table(table).pass_over_others();
    reader->pass_over_others();
    if (auto read = reader->finish(); !read) return tl::unexpected(read.error());
    return wishes;
}

}  // namespace atrium::doctor
