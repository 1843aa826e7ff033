#include "site_node/open_source.hpp"

#include "core/app/log.hpp"
#include "site_node/capture/aravis_source.hpp"
#include "site_node/capture/recording_source.hpp"
#include "site_node/simulated_room/open_room.hpp"

#include <set>
#include <string>

namespace atrium::site_node {
namespace {

using Source = Expected<std::unique_ptr<capture::FrameSource>>;

Expected<config::Rig> load_rig(const CaptureConfig& capture) {
    auto rig = config::load_rig(capture.rig);
    if (rig && capture.rate_hz > 0.0) rig->rate_hz = capture.rate_hz;
    return rig;
}

Source open_recording(const SiteNodeConfig& config) {
    constexpr std::size_t kMostReasons = 20;
    auto source = capture::RecordingSource::open(
        {.folder = config.capture.recording,
         .rate_hz = config.capture.rate_hz,
         .loop = config.capture.loop,
         .every = static_cast<std::size_t>(config.capture.every),
         .as_fast_as_possible = config.capture.as_fast_as_possible,
         .report_unreadable = [told = std::set<std::string>()](const std::string& reason) mutable {
             // a looping recording meets each picture again
             if (told.size() < kMostReasons && told.insert(reason).second)
                 app::log::warn("picture_left_out reason=\"{}\"", reason);
         }});
    if (!source) return tl::unexpected(source.error());
    return std::unique_ptr<capture::FrameSource>(std::move(*source));
}

Source open_cameras(const SiteNodeConfig& config, std::stop_token stop) {
    auto rig = load_rig(config.capture);
    if (!rig) return tl::unexpected(rig.error());
    const auto report = [](bool is_warning, const std::string& line) {
        app::log::write(is_warning ? app::log::Level::kWarn : app::log::Level::kInfo, line);
    };
    auto source = capture::AravisSource::open(
        *rig,
        cameras_options(
            config.capture.cameras,
            static_cast<std::size_t>(config.capture.min_cameras),
            std::chrono::nanoseconds(static_cast<std::int64_t>(config.capture.deadline_ms * 1e6))),
        report,
        stop);
    if (!source) return tl::unexpected(source.error());
    return std::unique_ptr<capture::FrameSource>(std::move(*source));
}

Source open_simulated_room(const SiteNodeConfig& config, std::stop_token stop) {
    const auto rig = load_rig(config.capture);
    if (!rig) return tl::unexpected(rig.error());
    return simulated_room::open_room(*rig, config.simulation, stop);
}

}  // namespace

Expected<std::unique_ptr<capture::FrameSource>> open_source(const SiteNodeConfig& config,
                                                            std::stop_token stop) {
    if (config.capture.source == "recording") return open_recording(config);
    if (config.capture.source == "cameras") return open_cameras(config, stop);
    return open_simulated_room(config, stop);
}

}  // namespace atrium::site_node
