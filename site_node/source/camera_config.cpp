#include "site_node/source/camera_config.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace atrium::site_node {
namespace {

constexpr config::Range kExposure_us{0, 1e7};
constexpr config::Range kGain_db{-1, 100};
constexpr config::Range kPacketBytes{0, 65535};
constexpr config::Range kPacketDelay_ns{-1, 1e9};

bool is_pixel_format(const std::string& name) {
    const auto& names = capture::camera_pixel_formats();
    return name.empty() || std::find(names.begin(), names.end(), name) != names.end();
}

std::string pixel_format_rule(const std::string& got) {
    std::string names;
    for (const std::string& name : capture::camera_pixel_formats())
        names += (names.empty() ? "" : ", ") + name;
    return fmt::format("must be one of {}, got '{}'", names, got);
}

std::optional<std::array<int, 4>> read_capture_region(config::TableReader& table) {
    if (!table.has("region_px")) return std::nullopt;
    std::array<double, 4> numbers{};
    table.read("region_px", numbers.data(), numbers.size(), {0, 65535});
    std::array<int, 4> region{};
    for (std::size_t i = 0; i < region.size(); ++i) {
        region[i] = static_cast<int>(numbers[i]);
        if (region[i] != numbers[i]) table.reject("region_px", "must be four whole numbers");
    }
    return region;
}

capture::CameraEntry read_camera(config::TableReader& table) {
    capture::CameraEntry camera;
    table.require("name");
    table.read("name", camera.name);
    table.read("serial", camera.serial);
    table.read("address", camera.address);
    if (camera.serial.empty() && camera.address.empty())
        table.reject("name", "needs the serial or the address of this camera beside it");
    capture::CameraSettings& settings = camera.settings;
    table.read("pixel_format", settings.pixel_format, capture::camera_pixel_formats());
    table.read("exposure_us", settings.exposure_us, kExposure_us);
    table.read("gain_db", settings.gain_db, kGain_db);
    table.read("white_balance", settings.white_balance);
    table.read("trigger_source", settings.trigger_source);
    table.read("packet_size", settings.packet_size, kPacketBytes);
    table.read("packet_delay_ns", settings.packet_delay_ns, kPacketDelay_ns);
    settings.region_px = read_capture_region(table);
    return camera;
}

// The cameras of the file, each with the settings that it does not share.
std::string cameras_text(const std::vector<capture::CameraEntry>& cameras) {
    std::string text;
    const auto add = [&](const char* key, const auto& value, bool is_set) {
        if (is_set) text += fmt::format(" {}={}", key, value);
    };
    for (const capture::CameraEntry& camera : cameras) {
        const capture::CameraSettings& own = camera.settings;
        text += (text.empty() ? "" : ", ") + camera.name;
        add("serial", camera.serial, !camera.serial.empty());
        add("address", camera.address, !camera.address.empty());
        add("pixel_format", own.pixel_format, !own.pixel_format.empty());
        add("exposure_us", own.exposure_us, own.exposure_us > 0.0);
        add("gain_db", own.gain_db, own.gain_db >= 0.0);
        add("white_balance", own.white_balance, !own.white_balance.empty());
        add("trigger_source", own.trigger_source, !own.trigger_source.empty());
        add("packet_size", own.packet_size, own.packet_size > 0);
        add("packet_delay_ns", own.packet_delay_ns, own.packet_delay_ns >= 0);
        if (own.region_px) text += fmt::format(" region_px=[{}]", fmt::join(*own.region_px, ", "));
    }
    return text.empty() ? "none" : text;
}

}  // namespace

void declare(CameraConfig& config, config::OptionSet& set) {
    set.show("capture.camera", [&config] { return cameras_text(config.options.cameras); });
    set.add("capture.trigger",
            config.trigger,
            "trigger of the cameras: an input line, the site's software, or their own clock",
            {"external", "software", "free-run"});
    capture::CameraSettings& common = config.options.common;
    set.add("capture.cameras.pixel_format",
            common.pixel_format,
            "GenICam format of all cameras, for example BayerRG8; empty: the camera's own");
    set.add("capture.cameras.exposure_us",
            common.exposure_us,
            "exposure [us]; 0: the camera's own",
            kExposure_us);
    set.add("capture.cameras.gain_db", common.gain_db, "gain [dB]; -1: the camera's own", kGain_db);
    set.add("capture.cameras.white_balance",
            common.white_balance,
            "off, auto-once, or red and blue gains, as in 1.8,1.4; empty: the camera's own");
    set.add("capture.cameras.trigger_source",
            common.trigger_source,
            "input line of the external trigger, for example Line1; empty: the camera's first");
    set.add("capture.cameras.packet_size",
            common.packet_size,
            "GigE Vision packet size [bytes]; 0: as large as the interface allows",
            kPacketBytes);
    set.add("capture.cameras.packet_delay_ns",
            common.packet_delay_ns,
            "pause between GigE Vision packets, for cameras that share a link [ns]; -1: the "
            "camera's own",
            kPacketDelay_ns);
    set.add("capture.cameras.packet_socket",
            config.options.use_packet_socket,
            "receive GigE Vision through packet sockets, if permitted (cap_net_raw)");
    set.add("capture.cameras.buffers",
            config.options.num_buffers,
            "picture buffers per camera; 0: as rate and deadline need",
            {0, 64});
    set.add("capture.cameras.realtime_priority",
            config.options.realtime_priority,
            "real-time priority of the receiving threads, if permitted; 0: none",
            {0, 99});
    set.add("capture.cameras.silent_periods",
            config.options.silent_periods,
            "a camera without a picture for this many periods, and at least 0.5 s, is lost",
            {2, 10000});
}

void read_cameras(config::TableReader& reader, CameraConfig& config) {
    config::TableReader table = reader.table("capture");
    std::set<std::string> names;
    std::map<std::string, std::string> name_of;  // by serial or address
    for (config::TableReader& camera : table.tables("camera")) {
        config.options.cameras.push_back(read_camera(camera));
        const capture::CameraEntry& entry = config.options.cameras.back();
        if (!names.insert(entry.name).second)
            camera.reject("name", "must be different for every camera");
        for (const auto& [key, value] :
             {std::pair("serial", entry.serial), std::pair("address", entry.address)}) {
            if (value.empty()) continue;
            const auto [before, is_new] = name_of.emplace(value, entry.name);
            if (!is_new)
                camera.reject(key,
                              fmt::format("is also that of '{}': '{}'", before->second, value));
        }
    }
}

Expected<void> check(const CameraConfig& config) {
    const auto wrong = [](std::string text) {
        return make_error(ErrorKind::kConfiguration, std::move(text));
    };
    if (config.options.cameras.empty()) {
        return wrong(
            "capture.camera: capture.source = \"cameras\" needs a [[capture.camera]] with name and "
            "serial or address for each camera of the rig; site_node --list-cameras shows them");
    }
    const std::string& format = config.options.common.pixel_format;
    if (!is_pixel_format(format))
        return wrong("capture.cameras.pixel_format: " + pixel_format_rule(format));
    const int num_buffers = config.options.num_buffers;
    if (num_buffers != 0 && num_buffers < 3) {
        return wrong(fmt::format(
            "capture.cameras.buffers: must be 0 (as needed) or at least 3, got {}", num_buffers));
    }
    return {};
}

capture::CamerasOptions cameras_options(const CameraConfig& config,
                                        std::size_t min_cameras,
                                        std::chrono::nanoseconds deadline) {
    capture::CamerasOptions options = config.options;
    options.trigger = config.trigger == "external"   ? capture::TriggerMode::kExternal
                      : config.trigger == "software" ? capture::TriggerMode::kSoftware
                                                     : capture::TriggerMode::kFreeRun;
    options.min_cameras = min_cameras;
    options.deadline = deadline;
    return options;
}

}  // namespace atrium::site_node
