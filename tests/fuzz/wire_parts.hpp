#pragma once

#include <feedback.h>
#include <presence.h>
#include <proxy.h>
#include <site.h>
#include <status.h>
#include <world.h>

namespace atrium::test {

/// A name that may be missing.
struct OptionalName {
    atrium_Name& name;
};

/// Each passes all fields of a wire struct to `visit`, in their order. The bindings name every
/// field, and a new field in idl/ does not compile until it is added here.
template <typename Visit>
void visit_parts(atrium_Latency& wire, Visit& visit) {
    auto& [median_ms, p99_ms, num_samples] = wire;
    visit(median_ms, p99_ms, num_samples);
}

template <typename Visit>
void visit_parts(atrium_ProcessorUse& wire, Visit& visit) {
    auto& [run_ns, waited_ns, run, waited, longest_wait, is_waiting_known, nice] = wire;
    visit(run_ns, waited_ns, run, waited, longest_wait, is_waiting_known, nice);
}

template <typename Visit>
void visit_parts(atrium_Camera& wire, Visit& visit) {
    auto& [name, width, height, fx, fy, cx, cy, skew, distortion, camera_from_site] = wire;
    visit(name, width, height, fx, fy, cx, cy, skew, distortion, camera_from_site);
}

template <typename Visit>
void visit_parts(atrium_SiteDescription& wire, Visit& visit) {
    auto& [site, cameras, bounds_min, bounds_max] = wire;
    visit(site, cameras, bounds_min, bounds_max);
}

template <typename Visit>
void visit_parts(atrium_SiteMesh& wire, Visit& visit) {
    auto& [site, frame_id, capture_time_ns, textured_cameras, draco] = wire;
    visit(site, frame_id, capture_time_ns, textured_cameras, draco);
}

template <typename Visit>
void visit_parts(atrium_CameraTexture& wire, Visit& visit) {
    auto& [site, camera, frame_id, capture_time_ns, x, y, width, height, colour, mask] = wire;
    visit(site, camera, frame_id, capture_time_ns, x, y, width, height, colour, mask);
}

template <typename Visit>
void visit_parts(atrium_SitePlacement& wire, Visit& visit) {
    auto& [site, world_from_site] = wire;
    visit(site, world_from_site);
}

template <typename Visit>
void visit_parts(atrium_SceneObject& wire, Visit& visit) {
    auto& [object,
           name,
           shape,
           size_m,
           mass_kg,
           friction,
           restitution,
           colour,
           model,
           model_scale,
           texture,
           world_from_object] = wire;
    visit(object, name, shape, size_m, mass_kg, friction, restitution, colour, model);
    visit(model_scale, texture, world_from_object);
}

template <typename Visit>
void visit_parts(atrium_SoftBody& wire, Visit& visit) {
    auto& [object, num_nodes, thickness_m, triangles, segments] = wire;
    visit(object, num_nodes, thickness_m, triangles, segments);
}

template <typename Visit>
void visit_parts(atrium_SoftBodyState& wire, Visit& visit) {
    auto& [object, tick, time_ns, origin_m, step_m, nodes] = wire;
    visit(object, tick, time_ns, origin_m, step_m, nodes);
}

template <typename Visit>
void visit_parts(atrium_Scenery& wire, Visit& visit) {
    auto& [name, model, model_scale, texture, colour, world_from_model] = wire;
    visit(name, model, model_scale, texture, colour, world_from_model);
}

template <typename Visit>
void visit_parts(atrium_ObjectState& wire, Visit& visit) {
    auto& [object, world_from_object, linear_velocity, angular_velocity] = wire;
    visit(object, world_from_object, linear_velocity, angular_velocity);
}

template <typename Visit>
void visit_parts(atrium_SceneState& wire, Visit& visit) {
    auto& [world, tick, time_ns, objects] = wire;
    visit(world, tick, time_ns, objects);
}

template <typename Visit>
void visit_parts(atrium_ProxyPoint& wire, Visit& visit) {
    auto& [place, velocity_mmps, normal] = wire;
    visit(place, velocity_mmps, normal);
}

template <typename Visit>
void visit_parts(atrium_Touch& wire, Visit& visit) {
    auto& [object, point_world] = wire;
    visit(object, point_world);
}

template <typename Visit>
void visit_parts(atrium_PersonProxy& wire, Visit& visit) {
    auto& [site, capture_time_ns, num_surfels, origin_m, step_m, points, touches] = wire;
    visit(site, capture_time_ns, num_surfels, origin_m, step_m, points, touches);
}

template <typename Visit>
void visit_parts(atrium_ObjectProxy& wire, Visit& visit) {
    auto& [object, origin_m, step_m, vertices, edges] = wire;
    visit(object, origin_m, step_m, vertices, edges);
}

/// Readers ignore the object unless it is to be added.
template <typename Visit>
void visit_parts(atrium_SceneCommand& wire, Visit& visit) {
    auto& [sender, kind, target, impulse_ns, point_object, goal_world, object] = wire;
    visit(sender, kind, target, impulse_ns, point_object, goal_world);
    if (kind == 0 || Visit::kWithIgnored) visit(object);
}

template <typename Visit>
void visit_parts(atrium_LeftOut& wire, Visit& visit) {
    auto& [cameras, phantoms, fragments, dropped_l, dropped, repaired, failed] = wire;
    visit(cameras, phantoms, fragments, dropped_l, dropped, repaired, failed);
}

template <typename Visit>
void visit_parts(atrium_CameraStatus& wire, Visit& visit) {
    auto& [name,
           connected,
           received,
           incomplete,
           resent,
           late,
           dropped,
           backwards,
           reconnects,
           offset_ms,
           age_ms] = wire;
    visit(name, connected, received, incomplete, resent, late, dropped, backwards, reconnects);
    visit(offset_ms, age_ms);
}

template <typename Visit>
void visit_parts(atrium_StreamState& wire, Visit& visit) {
    auto& [quality, divisor, send_every, cap_bit_per_s, cap_set_by, num_dropped] = wire;
    OptionalName by{cap_set_by};
    visit(quality, divisor, send_every, cap_bit_per_s, by, num_dropped);
}

template <typename Visit>
void visit_parts(atrium_StageTimes& wire, Visit& visit) {
    auto& [silhouettes_ms, hull_ms, coding_ms, publishing_ms] = wire;
    visit(silhouettes_ms, hull_ms, coding_ms, publishing_ms);
}

template <typename Visit>
void visit_parts(atrium_SiteStatus& wire, Visit& visit) {
    auto& [site,
           time_ns,
           captured,
           published,
           incomplete_used,
           dropped_incomplete,
           dropped_late,
           failed,
           left_out,
           bytes_published,
           metaframes_per_s,
           bytes_per_s,
           capture_to_publish,
           resident_bytes,
           cameras,
           stream,
           stages,
           mesh_bytes_per_s,
           texture_bytes_per_s,
           processor,
           first_output_s] = wire;
    visit(site, time_ns, captured, published, incomplete_used, dropped_incomplete, dropped_late);
    visit(failed, left_out, bytes_published, metaframes_per_s, bytes_per_s, capture_to_publish);
    visit(resident_bytes, cameras, stream, stages, mesh_bytes_per_s, texture_bytes_per_s);
    visit(processor, first_output_s);
}

template <typename Visit>
void visit_parts(atrium_WorldStatus& wire, Visit& visit) {
    auto& [world,
           time_ns,
           steps,
           meshes,
           rejected,
           sites,
           contacts,
           steps_per_s,
           latency,
           bytes,
           objects,
           resets,
           last_reset,
           skipped,
           refused,
           grabs,
           saves,
           bytes_published,
           bytes_per_s,
           step,
           prepare,
           meshes_dropped,
           state_tick,
           state_hash,
           processor,
           first_output_s] = wire;
    visit(world, time_ns, steps, meshes, rejected, sites, contacts, steps_per_s, latency, bytes);
    visit(objects, resets, last_reset, skipped, refused, grabs, saves, bytes_published);
    visit(bytes_per_s, step, prepare, meshes_dropped, state_tick, state_hash);
    visit(processor, first_output_s);
}

template <typename Visit>
void visit_parts(atrium_ViewerStatus& wire, Visit& visit) {
    auto& [viewer,
           time_ns,
           frames,
           shown,
           skipped,
           incomplete,
           rejected,
           frames_per_s,
           latency,
           bytes,
           processor,
           first_output_s,
           max_frames_per_s,
           scale,
           has_shadows,
           num_video_dropped] = wire;
    visit(viewer, time_ns, frames, shown, skipped, incomplete, rejected, frames_per_s, latency);
    visit(bytes, processor, first_output_s);
    visit(max_frames_per_s, scale, has_shadows, num_video_dropped);
}

template <typename Visit>
void visit_parts(atrium_StreamFeedback& wire, Visit& visit) {
    auto& [viewer,
           site,
           time_ns,
           newest_frame_id,
           complete,
           incomplete,
           late,
           samples,
           payload_bytes_per_s,
           min_delay_ms,
           sure_delay_ms,
           median_delay_ms,
           longest_wait_ms] = wire;
    visit(viewer, site, time_ns, newest_frame_id, complete, incomplete, late, samples);
    visit(payload_bytes_per_s, min_delay_ms, sure_delay_ms, median_delay_ms, longest_wait_ms);
}

template <typename Visit>
void visit_parts(atrium_Presence& wire, Visit& visit) {
    auto& [kind,
           member,
           instance,
           is_holder,
           num_written,
           host,
           pid,
           version,
           start_time_ns,
           is_clock_synchronised,
           clock_max_error_ns] = wire;
    visit(kind, member, instance, is_holder, num_written, host, pid, version, start_time_ns);
    visit(is_clock_synchronised, clock_max_error_ns);
}

}  // namespace atrium::test
