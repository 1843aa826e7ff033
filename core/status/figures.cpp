#include "core/status/figures.hpp"

#include "core/geometry/motion_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace atrium::status {
namespace {

// Marks losses that are neither normal (phantoms of a site) nor intended (metaframes dropped for a
// narrow network).
constexpr bool kAlarming = true;

// A stage whose status has only the median; 0 means none.
Figures::Stage stage(const char* name, double median_ms) {
    return {name, {median_ms, median_ms, median_ms > 0.0 ? 1U : 0U}, /*has_p99=*/false};
}

Figures::Camera figures_of(const bus::CameraStatus& camera) {
    return {camera,
            {{"incomplete", camera.num_incomplete},
             {"resent_packets", camera.num_resent},
             {"late", camera.num_late},
             {"dropped_no_buffer", camera.num_dropped},
             {"backwards", camera.num_backwards},
             {"reconnects", camera.num_reconnects}}};
}

Figures::Alarm alarm_of(const std::string& camera,
                        const bus::RigFault& fault,
                        bus::RigVerdict verdict) {
    if (verdict == bus::RigVerdict::kLate)
        return {fmt::format("camera {} is {} by {:.1f} instants",
                            camera,
                            fault.late_instants > 0.0 ? "late" : "early",
                            std::abs(fault.late_instants)),
                "check its trigger",
                fault.cure};
    const auto known = [](double value) {
        return value < 0.0 ? std::nullopt : std::optional(value);
    };
    return {fmt::format("camera {} was moved ({})",
                        camera,
                        geometry::motion_text(
                            known(fault.turned_deg), known(fault.moved_mm), fault.is_either)),
            "calibrate refine",
            fault.cure};
}

// "left in use 0.02 ms", "right clock wrong 20.13 ms", "attic missing", "cellar in use 2 regions".
std::string text_of(const bus::HostStatus& host) {
    if (host.num_regions > 0)
        return fmt::format("{} {} {} region{}",
                           host.name,
                           spaced(name_of(host.state)),
                           host.num_regions,
                           host.num_regions == 1 ? "" : "s");
    const bool has_clock =
        host.state != bus::HostState::kMissing && host.state != bus::HostState::kClockUnknown;
    const std::string clock = has_clock ? fmt::format(" {:.2f} ms", host.clock_offset_ms) : "";
    return fmt::format("{} {}{}", host.name, spaced(name_of(host.state)), clock);
}

Figures::Alarm alarm_of(const bus::HostStatus& host) {
    const std::string what = fmt::format("host {} is left out", host.name);
    switch (host.state) {
        case bus::HostState::kClockWrong:
            return {fmt::format("{}: its clock is off by {:.1f} ms", what, host.clock_offset_ms),
                    "atrium doctor there",
                    "let chrony or PTP set the clocks of all hosts of the site: chronyc tracking"};
        case bus::HostState::kClockUnknown:
            return {what + ": its clock is not known",
                    "atrium doctor there",
                    "the network delays the measurement of its clock, or it just came"};
        case bus::HostState::kOtherRig:
            return {what + (host.num_regions > 0 ? ": its rig, [hull] or regions are others"
                                                 : ": its rig, its rate or its cameras are others"),
                    "copy the rig there",
                    "copy the site's file and its rig from this host to all hosts, and start their "
                    "programs anew"};
        case bus::HostState::kLate:
            if (host.num_regions > 0)
                return {what + ": its meshes come too late",
                        "atrium plan",
                        "it has too many regions, or too few cores: atrium plan; or its network is "
                        "too slow: atrium doctor on that host"};
            return {what + ": its silhouettes come too late",
                    "atrium doctor there",
                    "its processor or its network is too slow: atrium doctor on that host"};
        default:
            if (host.num_regions > 0)
                return {what + ": nothing comes from it",
                        "is site_node running there?",
                        "start site_node on that host, and check its network"};
            return {what + ": nothing comes from it",
                    "is camera_node running there?",
                    "start camera_node on that host, and check its network"};
    }
}

// The part that all statuses have.
template <typename Status>
Figures process_figures(const Status& status, const char* rate_unit, double rate) {
    Figures figures;
    figures.time = status.time;
    figures.rate_unit = rate_unit;
    figures.rate = rate;
    figures.resident_bytes = status.resident_bytes;
    figures.processor = status.processor;
    figures.first_output_s = status.first_output_s;
    return figures;
}

// True if no counter decreased. Lists of one kind of program have the same names in the same order.
bool none_went_back(const std::vector<Counter>& before, const std::vector<Counter>& now) {
    return std::equal(before.begin(),
                      before.end(),
                      now.begin(),
                      now.end(),
                      [](const Counter& a, const Counter& b) { return a.total <= b.total; });
}

}  // namespace

Figures figures_of(const bus::SiteStatus& status) {
    Figures figures = process_figures(status, "metaframes/s", status.metaframes_per_s);
    figures.work = {{"metaframes_captured", status.num_metaframes_captured},
                    {"metaframes_published", status.num_metaframes_published},
                    {"bytes_published", status.num_bytes_published},
                    {"incomplete_used", status.num_incomplete_used},
                    {"contours_repaired", status.left_out.num_contours_repaired}};
    figures.losses = {{"dropped_incomplete", status.num_dropped_incomplete, kAlarming},
                      {"dropped_late", status.num_dropped_late, kAlarming},
                      {"dropped_for_rate", status.stream.num_dropped_for_rate},
                      {"failed", status.num_failed, kAlarming},
                      {"pictures_missing", status.left_out.num_cameras, kAlarming},
                      {"phantoms", status.left_out.num_phantoms},
                      {"fragments", status.left_out.num_fragments},
                      {"contours_dropped", status.left_out.num_contours_dropped},
                      {"regions_failed", status.left_out.num_regions_failed}};
    figures.stages = {stage("silhouettes", status.stages.silhouettes_ms),
                      stage("hull", status.stages.hull_ms),
                      stage("coding", status.stages.coding_ms),
                      stage("publishing", status.stages.publishing_ms),
                      {"capture_to_publish", status.capture_to_publish}};
    figures.topics = {{"SiteMesh", status.mesh_bytes_per_s},
                      {"CameraTexture", status.texture_bytes_per_s}};
    for (const bus::CameraStatus& camera : status.cameras)
        figures.cameras.push_back(figures_of(camera));
    figures.stream = status.stream;
    figures.coherence = status.coherence;
    const bus::RigCoherence& rig = status.coherence;
    if (rig.has_fault() && rig.fault.camera < rig.cameras.size())
        figures.alarms.push_back(
            alarm_of(rig.cameras[rig.fault.camera].name, rig.fault, rig.verdict));
    if (rig.verdict == bus::RigVerdict::kIncoherent)
        figures.alarms.push_back(
            {fmt::format("the silhouettes contradict the rig by {:.1f} px", rig.rms_px),
             "calibrate refine",
             rig.fault.cure});
    if (rig.verdict == bus::RigVerdict::kLenses)
        figures.alarms.push_back(
            {"the cameras have other lenses than the rig says (zoom, crop, "
             "stabilisation)",
             "calibrate refine --focal",
             rig.fault.cure});
    figures.hosts = status.hosts;
    std::string hosts;
    for (const bus::HostStatus& host : status.hosts) {
        hosts += (hosts.empty() ? "" : ", ") + text_of(host);
        if (host.state != bus::HostState::kInUse) figures.alarms.push_back(alarm_of(host));
    }
    if (!hosts.empty()) figures.notes.push_back({"hosts", hosts});
    // "door and desk look swapped: exchange their pictures"
    if (!status.finding.empty())
        figures.alarms.push_back({status.finding.substr(0, status.finding.find(": ")),
                                  "see monitor, or the site's log",
                                  status.finding});
    return figures;
}

Figures figures_of(const bus::WorldStatus& status) {
    Figures figures = process_figures(status, "steps/s", status.steps_per_s);
    figures.work = {{"steps", status.num_steps},
                    {"meshes_received", status.num_meshes_received},
                    {"steps_with_contact", status.num_contacts},
                    {"bytes_published", status.num_bytes_published},
                    {"states_saved", status.num_saves}};
    figures.losses = {{"rejected_samples", status.num_rejected},
                      {"refused_commands", status.num_refused, kAlarming},
                      {"meshes_dropped", status.num_meshes_dropped},
                      {"skipped_ticks", status.num_skipped_ticks, kAlarming},
                      {"objects_put_back", status.num_resets, kAlarming}};
    figures.stages = {
        {"prepare", status.prepare},
        {"step", status.step},
        {"capture_to_collision", status.capture_to_collision, true, /*elsewhere=*/true}};
    figures.notes = {{"objects", fmt::format("{}", status.num_objects)},
                     {"held", fmt::format("{}", status.num_grabs)},
                     {"published", fmt::format("{:.1f} kB/s", status.bytes_per_s / 1e3)}};
    if (status.last_reset != 0)
        figures.notes.push_back({"put_back_last", fmt::format("object {}", status.last_reset)});
    if (status.state_tick != 0) {
        figures.notes.push_back(
            {"state", fmt::format("{:016x} at tick {}", status.state_hash, status.state_tick)});
    }
    return figures;
}

Figures figures_of(const bus::ViewerStatus& status) {
    Figures figures = process_figures(status, "pictures/s", status.frames_per_s);
    figures.work = {{"frames", status.num_frames}, {"pairs_shown", status.num_pairs_shown}};
    figures.losses = {{"pairs_skipped", status.num_pairs_skipped},
                      {"incomplete_pairs", status.num_incomplete},
                      {"rejected_samples", status.num_rejected}};
    figures.stages = {{"capture_to_display", status.capture_to_display, true, /*elsewhere=*/true}};
    if (status.max_frames_per_s > 0.0) {
        figures.notes.push_back({"quality",
                                 fmt::format("{:.0f} pictures/s at most, scale {:.2g}, {} shadows",
                                             status.max_frames_per_s,
                                             status.scale,
                                             status.has_shadows ? "with" : "no")});
    }
    if (status.num_video_dropped > 0)
        figures.notes.push_back({"video_dropped", fmt::format("{}", status.num_video_dropped)});
    return figures;
}

Figures figures_of(const bus::CameraNodeStatus& status) {
    Figures figures = process_figures(status, "silhouettes/s", status.silhouettes_per_s);
    figures.work = {{"pictures", status.num_pictures},
                    {"silhouettes", status.num_silhouettes},
                    {"textures", status.num_textures},
                    {"bytes_published", status.num_bytes_published}};
    figures.losses = {{"dropped_late", status.num_dropped_late, kAlarming},
                      {"failed", status.num_failed, kAlarming}};
    figures.stages = {{"capture_to_silhouette", status.capture_to_silhouette}};
    figures.topics = {{"CameraSilhouette", status.silhouette_bytes_per_s},
                      {"CameraTexture", status.texture_bytes_per_s}};
    for (const bus::CameraStatus& camera : status.cameras)
        figures.cameras.push_back(figures_of(camera));
    return figures;
}

Figures figures_of(const bus::RegionNodeStatus& status) {
    Figures figures = process_figures(status, "orders/s", status.orders_per_s);
    figures.work = {{"orders", status.num_orders},
                    {"meshes", status.num_meshes},
                    {"bytes_published", status.num_bytes_published}};
    figures.losses = {{"dropped_late", status.num_dropped_late, kAlarming},
                      {"failed", status.num_failed, kAlarming}};
    figures.stages = {{"order_to_mesh", status.order_to_mesh},
                      stage("hull", status.stages.hull_ms),
                      stage("coding", status.stages.coding_ms),
                      stage("publishing", status.stages.publishing_ms)};
    figures.topics = {{"RegionMeshes", status.bytes_per_s}};
    figures.notes = {{"regions", fmt::format("{}", status.num_regions)}};
    return figures;
}

std::string spaced(std::string name) {
    std::replace(name.begin(), name.end(), '_', ' ');
    return name;
}

std::string rate_text(double rate, const std::string& unit) {
    return fmt::format("{:.1f} {}", rate, unit);
}

const char* name_of(bus::HostState state) {
    switch (state) {
        case bus::HostState::kInUse:
            return "in_use";
        case bus::HostState::kClockUnknown:
            return "clock_unknown";
        case bus::HostState::kClockWrong:
            return "clock_wrong";
        case bus::HostState::kLate:
            return "too_late";
        case bus::HostState::kOtherRig:
            return "other_rig";
        default:
            return "missing";
    }
}

const char* name_of(bus::RigVerdict verdict) {
    constexpr const char* kNames[] = {
        "unknown", "coherent", "moved", "late", "incoherent", "lenses"};
    return kNames[std::min<std::size_t>(static_cast<std::size_t>(verdict), std::size(kNames) - 1)];
}

std::vector<std::string> rig_items(const bus::RigCoherence& coherence) {
    if (coherence.verdict == bus::RigVerdict::kUnknown || coherence.cameras.empty()) return {};
    const bus::CameraCoherence& worst =
        *std::ranges::max_element(coherence.cameras, {}, &bus::CameraCoherence::rms_px);
    return {name_of(coherence.verdict),
            fmt::format("{:.2f} px", coherence.rms_px),
            fmt::format("worst {} {:.2f} px", worst.name, worst.rms_px),
            fmt::format("{} instants", coherence.num_instants)};
}

bool may_be_same_process(const Figures& before, const Figures& now) {
    if (now.time < before.time || !none_went_back(before.work, now.work) ||
        !none_went_back(before.losses, now.losses) || before.cameras.size() != now.cameras.size()) {
        return false;
    }
    for (std::size_t i = 0; i < now.cameras.size(); ++i) {
        if (before.cameras[i].status.name != now.cameras[i].status.name ||
            before.cameras[i].status.num_received > now.cameras[i].status.num_received ||
            !none_went_back(before.cameras[i].losses, now.cameras[i].losses)) {
            return false;
        }
    }
    return before.processor.run_ns <= now.processor.run_ns;
}

}  // namespace atrium::status
