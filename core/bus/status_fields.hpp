#pragma once

#include "core/bus/field_visitor.hpp"

/// Lists the fields of the statuses, like fields.hpp, which includes it. Private to core/bus and
/// its tests.
namespace atrium::bus {

void fields(auto& v, Of<LeftOutTotals> auto& m, auto& w) {
    v(m.num_cameras, w.num_cameras);
    v(m.num_phantoms, w.num_phantoms);
    v(m.num_fragments, w.num_fragments);
    v("SiteStatus.left_out.dropped_l", m.dropped_l, w.dropped_l, kStatistic);
    v(m.num_contours_dropped, w.num_contours_dropped);
    v(m.num_contours_repaired, w.num_contours_repaired);
    v(m.num_regions_failed, w.num_regions_failed);
}

void fields(auto& v, Of<CameraStatus> auto& m, auto& w) {
    const RangeOrNone age{kStatistic, -1.0};
    v("SiteStatus.cameras.name", m.name, w.name, Text::kName);
    v("SiteStatus.cameras.connected", m.connected, w.connected);
    v(m.num_received, w.num_received);
    v(m.num_incomplete, w.num_incomplete);
    v(m.num_resent, w.num_resent);
    v(m.num_late, w.num_late);
    v(m.num_dropped, w.num_dropped);
    v(m.num_backwards, w.num_backwards);
    v(m.num_reconnects, w.num_reconnects);
    v("SiteStatus.cameras.offset_ms", m.offset_ms, w.offset_ms, within(kMaxStatistic));
    v("SiteStatus.cameras.last_picture_age_ms", m.last_picture_age_ms, w.last_picture_age_ms, age);
}

void fields(auto& v, Of<StreamState> auto& m, auto& w) {
    v("SiteStatus.stream.jpeg_quality", m.jpeg_quality, w.jpeg_quality, Range{1, 100});
    v("SiteStatus.stream.colour_divisor", m.colour_divisor, w.colour_divisor, Range{1, 2});
    v("SiteStatus.stream.send_every", m.send_every, w.send_every, Range{1, kMaxSendEvery});
    v("SiteStatus.stream.cap_bit_per_s", m.cap_bit_per_s, w.cap_bit_per_s, kStatistic);
    v("SiteStatus.stream.cap_set_by", m.cap_set_by, w.cap_set_by, Text::kNameOrNone);
    v(m.num_dropped_for_rate, w.num_dropped_for_rate);
}

void fields(auto& v, Of<StageTimes> auto& m, auto& w) {
    v("SiteStatus.stages", m.silhouettes_ms, w.silhouettes_ms, kStatistic);
    v("SiteStatus.stages", m.hull_ms, w.hull_ms, kStatistic);
    v("SiteStatus.stages", m.coding_ms, w.coding_ms, kStatistic);
    v("SiteStatus.stages", m.publishing_ms, w.publishing_ms, kStatistic);
}

void fields(auto& v, Of<CameraCoherence> auto& m, auto& w) {
    v("SiteStatus.coherence.cameras.name", m.name, w.name, Text::kName);
    v("SiteStatus.coherence.cameras.rms_px", m.rms_px, w.rms_px, kStatistic);
    v("SiteStatus.coherence.cameras.share", m.share, w.share, Range{0, 1});
    v(m.num_tangencies, w.num_tangencies);
}

void fields(auto& v, Of<RigFault> auto& m, auto& w) {
    const RangeOrNone certain{kStatistic, -1.0};
    const Range instants = within(kMaxStatistic);
    v("SiteStatus.coherence.fault.camera", m.camera, w.camera, AtMost{kMaxCamerasPerSite - 1});
    v("SiteStatus.coherence.fault.turned_deg", m.turned_deg, w.turned_deg, certain);
    v("SiteStatus.coherence.fault.moved_mm", m.moved_mm, w.moved_mm, certain);
    v("SiteStatus.coherence.fault.is_either", m.is_either, w.is_either);
    v("SiteStatus.coherence.fault.late_instants", m.late_instants, w.late_instants, instants);
    v("SiteStatus.coherence.fault.effect_px", m.effect_px, w.effect_px, kStatistic);
    v("SiteStatus.coherence.fault.cure", m.cure, w.cure, Text::kLine);
}

void fields(auto& v, Of<RigCoherence> auto& m, auto& w) {
    v("SiteStatus.coherence.verdict", m.verdict, w.verdict, Last{RigVerdict::kLenses});
    v("SiteStatus.coherence.rms_px", m.rms_px, w.rms_px, kStatistic);
    v(m.num_instants, w.num_instants);
    v("SiteStatus.coherence.cameras", m.cameras, w.cameras, AtMost{kMaxCamerasPerSite});
    v.part(m.fault, w.fault);
    v.rule("SiteStatus.coherence.fault.camera",
           !m.has_fault() || m.fault.camera < m.cameras.size(),
           "is no camera of the rig");
}

void fields(auto& v, Of<ProcessorUse> auto& m, auto& w) {
    v(m.run_ns, w.run_ns);
    v(m.waited_ns, w.waited_ns);
    v("processor: seconds per second", m.run_per_s, w.run_per_s, kStatistic);
    v("processor: seconds per second", m.waited_per_s, w.waited_per_s, kStatistic);
    v("processor: seconds per second", m.longest_wait_per_s, w.longest_wait_per_s, kStatistic);
    v("processor.is_waiting_known", m.is_waiting_known, w.is_waiting_known);
    v("processor.nice", m.nice, w.nice, Range{-20, 19});
}

void fields(auto& v, Of<HostStatus> auto& m, auto& w) {
    const Range offset = within(kMaxStatistic);
    v("SiteStatus.hosts.name", m.name, w.name, Text::kName);
    v("SiteStatus.hosts.state", m.state, w.state, Last{HostState::kOtherRig});
    v("SiteStatus.hosts.clock_offset_ms", m.clock_offset_ms, w.clock_offset_ms, offset);
    v("SiteStatus.hosts.clock_error_ms", m.clock_error_ms, w.clock_error_ms, kStatistic);
    v(m.num_cameras, w.num_cameras);
    v(m.num_regions, w.num_regions);
    v(m.num_left_out, w.num_left_out);
}

// status.idl

void fields(auto& v, Of<SiteStatus> auto& m, auto& w) {
    v.key("SiteStatus.site", m.site, w.site, Text::kName);
    v("SiteStatus.time", m.time, w.time_ns);
    v(m.num_metaframes_captured, w.num_metaframes_captured);
    v(m.num_metaframes_published, w.num_metaframes_published);
    v(m.num_incomplete_used, w.num_incomplete_used);
    v(m.num_dropped_incomplete, w.num_dropped_incomplete);
    v(m.num_dropped_late, w.num_dropped_late);
    v(m.num_failed, w.num_failed);
    v.part(m.left_out, w.left_out);
    v(m.num_bytes_published, w.num_bytes_published);
    v("SiteStatus.metaframes_per_s", m.metaframes_per_s, w.metaframes_per_s, kStatistic);
    v("SiteStatus.bytes_per_s", m.bytes_per_s, w.bytes_per_s, kStatistic);
    v("SiteStatus.capture_to_publish", m.capture_to_publish, w.capture_to_publish);
    v(m.resident_bytes, w.resident_bytes);
    v("SiteStatus.cameras", m.cameras, w.cameras, AtMost{kMaxCamerasPerSite});
    v.part(m.stream, w.stream);
    v.part(m.stages, w.stages);
    v("SiteStatus.mesh_bytes_per_s", m.mesh_bytes_per_s, w.mesh_bytes_per_s, kStatistic);
    v("SiteStatus.texture_bytes_per_s", m.texture_bytes_per_s, w.texture_bytes_per_s, kStatistic);
    v.part(m.processor, w.processor);
    v("first_output_s", m.first_output_s, w.first_output_s, kStatistic);
    v.part(m.coherence, w.coherence);
    v("SiteStatus.finding", m.finding, w.finding, Text::kLine);
    v("SiteStatus.hosts", m.hosts, w.hosts, AtMost{kMaxCamerasPerSite});
}

void fields(auto& v, Of<WorldStatus> auto& m, auto& w) {
    v.key("WorldStatus.world", m.world, w.world, Text::kName);
    v("WorldStatus.time", m.time, w.time_ns);
    v(m.num_steps, w.num_steps);
    v(m.num_meshes_received, w.num_meshes_received);
    v(m.num_rejected, w.num_rejected);
    v(m.num_sites, w.num_sites);
    v(m.num_contacts, w.num_contacts);
    v("WorldStatus.steps_per_s", m.steps_per_s, w.steps_per_s, kStatistic);
    v("WorldStatus.capture_to_collision", m.capture_to_collision, w.capture_to_collision);
    v(m.resident_bytes, w.resident_bytes);
    v(m.num_objects, w.num_objects);
    v(m.num_resets, w.num_resets);
    v(m.last_reset, w.last_reset);
    v(m.num_skipped_ticks, w.num_skipped_ticks);
    v(m.num_refused, w.num_refused);
    v(m.num_grabs, w.num_grabs);
    v(m.num_saves, w.num_saves);
    v(m.num_bytes_published, w.num_bytes_published);
    v("WorldStatus.bytes_per_s", m.bytes_per_s, w.bytes_per_s, kStatistic);
    v("WorldStatus.step", m.step, w.step);
    v("WorldStatus.prepare", m.prepare, w.prepare);
    v(m.num_meshes_dropped, w.num_meshes_dropped);
    v(m.state_tick, w.state_tick);
    v(m.state_hash, w.state_hash);
    v.part(m.processor, w.processor);
    v("first_output_s", m.first_output_s, w.first_output_s, kStatistic);
}

void fields(auto& v, Of<ViewerStatus> auto& m, auto& w) {
    v.key("ViewerStatus.viewer", m.viewer, w.viewer, Text::kName);
    v("ViewerStatus.time", m.time, w.time_ns);
    v(m.num_frames, w.num_frames);
    v(m.num_pairs_shown, w.num_pairs_shown);
    v(m.num_pairs_skipped, w.num_pairs_skipped);
    v(m.num_incomplete, w.num_incomplete);
    v(m.num_rejected, w.num_rejected);
    v("ViewerStatus.frames_per_s", m.frames_per_s, w.frames_per_s, kStatistic);
    v("ViewerStatus.capture_to_display", m.capture_to_display, w.capture_to_display);
    v(m.resident_bytes, w.resident_bytes);
    v.part(m.processor, w.processor);
    v("first_output_s", m.first_output_s, w.first_output_s, kStatistic);
    v("ViewerStatus.max_frames_per_s", m.max_frames_per_s, w.max_frames_per_s, kStatistic);
    v("ViewerStatus.scale", m.scale, w.scale, Range{0, 1});
    v("ViewerStatus.has_shadows", m.has_shadows, w.has_shadows);
    v(m.num_video_dropped, w.num_video_dropped);
}

}  // namespace atrium::bus
