#include "site_node/source/open_source.hpp"

#include "core/app/log.hpp"
#include "site_node/capture/aravis_source.hpp"
#include "site_node/capture/camera_discovery.hpp"
#include "site_node/capture/recording_source.hpp"
#include "site_node/simulated_room/open_room.hpp"
#include "site_node/source/aligned_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <system_error>
#include <vector>

namespace atrium::site_node {
namespace {

using Source = Expected<std::unique_ptr<capture::FrameSource>>;

Expected<config::Rig> load_rig(const CaptureConfig& capture) {
    auto rig = config::load_rig(capture.rig);
    if (rig && capture.rate_hz > 0.0) rig->rate_hz = capture.rate_hz;
    return rig;
}

Source open_recording(const CaptureConfig& config, bool is_calibrated) {
    constexpr std::size_t kMostReasons = 20;
    auto source = capture::RecordingSource::open(
        {.folder = config.recording,
         .rate_hz = config.rate_hz,
         .loop = config.loop,
         .every = static_cast<std::size_t>(config.every),
         .as_fast_as_possible = config.as_fast_as_possible,
         .ignore_silhouettes = !is_calibrated,
         .needs_rig = is_calibrated,
         .report_unreadable = [told = std::set<std::string>()](const std::string& reason) mutable {
             // a looping recording meets each picture again
             if (told.size() < kMostReasons && told.insert(reason).second)
                 app::log::warn("picture_left_out reason=\"{}\"", reason);
         }});
    if (!source) return tl::unexpected(source.error());
    const double recorded_hz = (*source)->recorded_hz();
    const bool keeps_pace = config.rate_hz > 0.0 && !config.as_fast_as_possible;
    if (keeps_pace && recorded_hz > 0.0 && std::abs(config.rate_hz / recorded_hz - 1.0) > 0.1) {
        app::log::warn(
            "other_rate recorded_hz={:.1f} rate_hz={:g}: it plays {} than it was; "
            "capture.rate_hz = 0 plays it as recorded",
            recorded_hz,
            config.rate_hz,
            config.rate_hz > recorded_hz ? "faster" : "slower");
    }
    return std::unique_ptr<capture::FrameSource>(std::move(*source));
}

Source open_cameras(const config::Rig& rig,
                    const CameraConfig& cameras,
                    const CaptureConfig& config,
                    std::stop_token stop) {
    const auto report = [](bool is_warning, const std::string& line) {
        app::log::write(is_warning ? app::log::Level::kWarn : app::log::Level::kInfo, line);
    };
    auto source = capture::AravisSource::open(
        rig,
        cameras_options(
            cameras,
            static_cast<std::size_t>(config.min_cameras),
            std::chrono::nanoseconds(static_cast<std::int64_t>(config.deadline_ms * 1e6))),
        report,
        stop);
    if (!source) return tl::unexpected(source.error());
    return std::unique_ptr<capture::FrameSource>(std::move(*source));
}

Source open_simulated_room(const CaptureConfig& config,
                           const simulation::RoomConfig& room,
                           std::stop_token stop) {
    const auto rig = load_rig(config);
    if (!rig) return tl::unexpected(rig.error());
    return simulated_room::open_room(*rig, room, stop);
}

// All cameras that answer, named by their serial numbers.
Expected<std::vector<capture::CameraEntry>> discovered() {
    std::vector<capture::CameraEntry> entries;
    for (const capture::FoundCamera& found : capture::discover_cameras()) {
        capture::CameraEntry entry;
        entry.name = found.serial;
        entry.serial = found.serial;
        if (found.protocol == "GigEVision") entry.address = found.address;
        if (!config::is_valid_name(entry.name))
            return make_error(
                ErrorKind::kConfiguration,
                fmt::format("capture.camera: the camera at {} has the serial number '{}', which is "
                            "no name; name the cameras in a file with [[capture.camera]]",
                            found.address,
                            found.serial));
        entries.push_back(std::move(entry));
    }
    if (entries.size() < 2)
        return make_error(ErrorKind::kNotFound,
                          fmt::format("{} camera answers, two or more are needed: check power, "
                                      "network and firewall (UDP port 3956); site_node "
                                      "--list-cameras shows what answers",
                                      entries.empty() ? "no" : "one"));
    return entries;
}

// Cameras of which only names are known, and sizes if an older rig has them; the others send their
// whole sensors. The rig may also be the one that the calibration is going to write.
Expected<config::Rig> uncalibrated_rig(const CaptureConfig& config,
                                       const std::vector<capture::CameraEntry>& entries) {
    config::Rig older;
    std::error_code failure;
    if (!config.rig.empty() && std::filesystem::exists(config.rig, failure)) {
        auto loaded = config::load_rig(config.rig);
        if (!loaded) return loaded;
        older = std::move(*loaded);
    }
    config::Rig rig;
    rig.rate_hz = config.rate_hz > 0.0 ? config.rate_hz : older.rate_hz;
    for (const capture::CameraEntry& entry : entries) {
        geometry::CalibratedCamera& camera = rig.cameras.emplace_back();
        camera.name = entry.name;
        const auto same =
            std::ranges::find(older.cameras, entry.name, &geometry::CalibratedCamera::name);
        if (same == older.cameras.end()) continue;
        camera.intrinsics.width = same->intrinsics.width;
        camera.intrinsics.height = same->intrinsics.height;
    }
    return rig;
}

}  // namespace

Source open_source(const CaptureConfig& config,
                   const simulation::RoomConfig& room,
                   std::stop_token stop) {
    if (config.aligned) return open_aligned_source(config, room, {}, stop);
    if (config.source == "recording") return open_recording(config, true);
    if (config.source != "cameras") return open_simulated_room(config, room, stop);
    const auto rig = load_rig(config);
    if (!rig) return tl::unexpected(rig.error());
    return open_cameras(*rig, config.cameras, config, stop);
}

Source open_aligned_source(const CaptureConfig& config,
                           const simulation::RoomConfig& room,
                           const std::vector<std::string>& cameras,
                           std::stop_token stop) {
    if (config.source != "cameras") {
        CaptureConfig free = config;
        free.aligned = false;
        auto source = open_source(free, room, stop);
        if (!source) return source;
        const double rate_hz = config.rate_hz > 0.0 ? config.rate_hz : (*source)->rig().rate_hz;
        auto aligned = AlignedSource::create(std::move(*source), cameras, rate_hz);
        if (!aligned) return tl::unexpected(aligned.error());
        return std::unique_ptr<capture::FrameSource>(std::move(*aligned));
    }
    auto rig = load_rig(config);
    if (!rig) return tl::unexpected(rig.error());
    const auto is_chosen = [&](const auto& camera) {
        return cameras.empty() || std::ranges::find(cameras, camera.name) != cameras.end();
    };
    std::erase_if(rig->cameras, std::not_fn(is_chosen));
    CaptureConfig own = config;
    std::erase_if(own.cameras.options.cameras, std::not_fn(is_chosen));
    own.cameras.options.is_trigger_aligned = true;
    if (!cameras.empty()) own.min_cameras = 1;  // the others are searched for
    return open_cameras(*rig, own.cameras, own, stop);
}

Source open_uncalibrated_source(const CaptureConfig& config,
                                const simulation::RoomConfig& room,
                                std::stop_token stop) {
    if (config.source == "recording") return open_recording(config, false);
    if (config.source != "cameras") return open_simulated_room(config, room, stop);
    CaptureConfig all = config;
    all.min_cameras = 0;
    std::vector<capture::CameraEntry>& entries = all.cameras.options.cameras;
    if (entries.empty()) {
        auto found = discovered();
        if (!found) return tl::unexpected(found.error());
        entries = std::move(*found);
    }
    if (auto checked = check(all.cameras); !checked) return tl::unexpected(checked.error());
    const auto rig = uncalibrated_rig(config, entries);
    if (!rig) return tl::unexpected(rig.error());
    return open_cameras(*rig, all.cameras, all, stop);
}

}  // namespace atrium::site_node
