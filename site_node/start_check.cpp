#include "site_node/start_check.hpp"

#include "core/app/log.hpp"
#include "core/base/write_check.hpp"
#include "site_node/capture/recording_source.hpp"
#include "site_node/hull/input_limits.hpp"
#include "site_node/rig_check/bounds_check.hpp"
#include "site_node/rig_check/rig_geometry.hpp"

#include <fmt/format.h>

namespace atrium::site_node {
namespace {

namespace fs = std::filesystem;

// What a run writes at least; a start with less free space would end in the middle.
constexpr std::uint64_t kBackgroundBytes = 32U << 20;
constexpr std::uint64_t kSilhouetteBytes = 64U << 20;
constexpr std::uint64_t kPreviewBytes = 8U << 20;

// Whether the hull is cut at the bounds of the rig.
bool are_bounds_of_rig(const config::Rig& rig, const HullStageOptions& hull) {
    return !hull.bounds && hull.regions.empty() && rig.has_bounds &&
           rig.cameras.size() + hull::kViewsOfBounds <= hull::kMaxViews;
}

void doubt_regions(std::span<const RegionOptions> regions, const config::Rig& rig) {
    for (const std::string& pair : overlapping_regions(regions))
        app::log::warn("hull.region: {} overlap; people there appear twice in the mesh", pair);
    for (const RegionOptions& region : regions) {
        const auto bounds = rig.has_bounds ? std::optional(rig.bounds_site) : std::nullopt;
        if (const auto doubt = rig_check::check_region(region.bounds, rig.cameras, bounds))
            app::log::warn("region_looks_wrong region={} reason=\"{}\"", region.name, doubt->text);
    }
}

}  // namespace

Expected<void> check_places(const SiteNodeConfig& config) {
    if (auto found = check_places(config.capture); !found) return found;
    if (config.learn_background && !config.pipeline.background.folder.empty()) {
        if (auto fits = check_folder_writable(config.pipeline.background.folder,
                                              kBackgroundBytes,
                                              "segmentation.background_folder");
            !fits)
            return fits;
    }
    if (!config.write_silhouettes.empty()) {
        if (auto fits = check_folder_writable(
                config.write_silhouettes, kSilhouetteBytes, "--write-silhouettes");
            !fits)
            return fits;
    }
    if (!config.record.folder.empty()) {
        if (auto fits = record::check_new_folder(config.record.folder); !fits) return fits;
    }
    if (config.preview.has_extension())
        return check_folder_writable(
            fs::absolute(config.preview).parent_path(), kPreviewBytes, "--preview");
    return {};
}

Expected<config::Rig> load_checked_rig(const SiteNodeConfig& config) {
    const bool is_recording = config.capture.source == "recording";
    if (is_recording) {
        if (auto room = capture::check_is_room(config.capture.recording); !room)
            return tl::unexpected(room.error());
    }
    auto rig = config::load_rig(is_recording ? config.capture.recording : config.capture.rig);
    if (!rig) return rig;
    const fs::path file = is_recording ? config.capture.recording / "rig.toml" : config.capture.rig;
    for (const rig_check::Finding& finding : rig_check::check_rig(rig->cameras, rig->unit_m)) {
        if (finding.is_error) {
            return make_error(ErrorKind::kConfiguration,
                              fmt::format("{}: {}", file.string(), finding.text));
        }
        app::log::warn("rig_looks_wrong file={} reason=\"{}\"", file.string(), finding.text);
    }
    if (rig->has_bounds) {
        if (const auto doubt = rig_check::check_bounds(rig->bounds_site, rig->cameras, rig->unit_m))
            app::log::warn("rig_looks_wrong file={} reason=\"{}\"", file.string(), doubt->text);
    }
    if (config.capture.rate_hz > 0.0) rig->rate_hz = config.capture.rate_hz;
    return rig;
}

Expected<config::Rig> load_checked_description(const SiteNodeConfig& config) {
    if (auto checked = check(config); !checked) return tl::unexpected(checked.error());
    if (auto found = check_places(config); !found) return tl::unexpected(found.error());
    auto rig = load_checked_rig(config);
    if (!rig) return rig;
    if (!config.hosts.empty()) {
        if (auto fits = check_hosts(config, *rig); !fits) return tl::unexpected(fits.error());
    }
    if (config.capture.min_cameras > static_cast<int>(rig->cameras.size())) {
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("capture.min_cameras: must not exceed the number of cameras, {}, got {}",
                        rig->cameras.size(),
                        config.capture.min_cameras));
    }
    if (auto fits = check_areas(config.pipeline, *rig); !fits) return tl::unexpected(fits.error());
    if (auto fits = segmentation_worker::check(config.pipeline.worker); !fits)
        return tl::unexpected(fits.error());
    HullStageOptions hull = config.pipeline.hull;
    if (are_bounds_of_rig(*rig, hull)) hull.bounds = rig->bounds_site;
    const auto stage =
        HullStage::create(rig->cameras, hull, config.pipeline.silhouette.tolerance_px);
    if (!stage) return tl::unexpected(stage.error());
    doubt_regions(hull.regions, *rig);
    return rig;
}

void take_bounds(const config::Rig& rig, HullStageOptions& hull) {
    if (hull.bounds || !hull.regions.empty() || !rig.has_bounds) return;
    if (!are_bounds_of_rig(rig, hull)) {
        app::log::warn(
            "the bounds of the rig do not cut the hull: with more than {} cameras nothing can",
            hull::kMaxViews - hull::kViewsOfBounds);
        return;
    }
    hull.bounds = rig.bounds_site;
    app::log::info("hull bounds from=rig min=\"{}\" max=\"{}\"",
                   fmt::join(rig.bounds_site.min, ","),
                   fmt::join(rig.bounds_site.max, ","));
}

}  // namespace atrium::site_node
