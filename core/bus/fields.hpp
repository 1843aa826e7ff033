#pragma once

#include "core/bus/field_visitor.hpp"
#include "core/bus/host_fields.hpp"
#include "core/bus/status_fields.hpp"

/// Lists the fields of each message, in the order of idl/; status_fields.hpp has those of statuses.
/// These lists drive `to_wire`, `from_wire`, `check` and `payload_bytes`. Private to core/bus and
/// its tests.
///
/// `m` is a message of messages.hpp and `w` its wire struct. The visitor `v` gets
///     v(m.count, w.count)             an integer without limits
///     v(name, m.field, w.field, limits)
///     v.key(name, m.key, w.key, limits)
///     v.part(m.part, w.part)          a struct with a list here
///     v.rule(name, holds, why)        a condition on several fields
/// The name is that of error messages. Visitors go through a list in its order: `limits` may depend
/// on the fields before it.
namespace atrium::bus {

// Parts of messages.

void fields(auto& v, Of<geometry::CalibratedCamera> auto& m, auto& w) {
    v("SiteDescription.cameras.name", m.name, w.name, Text::kName);
    const Range side{1, kMaxImageSide_px};
    v("SiteDescription.cameras.width", m.intrinsics.width, w.width, side);
    v("SiteDescription.cameras.height", m.intrinsics.height, w.height, side);
    v("SiteDescription.cameras.fx", m.intrinsics.fx, w.fx, Positive{kMaxIntrinsic});
    v("SiteDescription.cameras.fy", m.intrinsics.fy, w.fy, Positive{kMaxIntrinsic});
    const Range intrinsic = within(kMaxIntrinsic);
    v("SiteDescription.cameras.cx cy skew", m.intrinsics.cx, w.cx, intrinsic);
    v("SiteDescription.cameras.cx cy skew", m.intrinsics.cy, w.cy, intrinsic);
    v("SiteDescription.cameras.cx cy skew", m.intrinsics.skew, w.skew, intrinsic);
    v("SiteDescription.cameras.distortion", m.intrinsics.distortion, w.distortion, intrinsic);
    v("SiteDescription.cameras.camera_from_site", m.camera_from_site, w.camera_from_site);
}

void fields(auto& v, Of<FrameKey> auto& m, auto& w) {
    v(m.frame_id, w.frame_id);
    v("SiteMesh.texture_frames.capture_time", m.capture_time, w.capture_time_ns);
}

void fields(auto& v, Of<ObjectState> auto& m, auto& w) {
    const Range speed = within(kMaxSpeed);
    v(m.object, w.object);
    v("SceneState.objects.world_from_object", m.world_from_object, w.world_from_object);
    v("SceneState.objects.linear_velocity", m.linear_velocity, w.linear_velocity, speed);
    v("SceneState.objects.angular_velocity", m.angular_velocity, w.angular_velocity, speed);
}

void fields(auto& v, Of<ProxyPoint> auto& m, auto& w) {
    v("PersonProxy.points.place", m.place, w.place);
    v("PersonProxy.points.velocity_mmps", m.velocity_mmps, w.velocity_mmps);
    v("PersonProxy.points.normal", m.normal, w.normal);
}

void fields(auto& v, Of<Touch> auto& m, auto& w) {
    const Range place = within(kMaxCoordinate_m);
    v(m.object, w.object);
    v("PersonProxy.touches.point_world", m.point_world, w.point_world, place);
}

void fields(auto& v, Of<Fingerprint> auto& m, auto& w) {
    v(m.num_bytes, w.num_bytes);
    v(m.hash, w.hash);
}

void fields(auto& v, Of<SavedWorld> auto& m, auto& w) {
    v("SavedWorlds.worlds.name", m.name, w.name, Text::kName);
    v("SavedWorlds.worlds.time", m.time, w.time_ns);
    v(m.num_objects, w.num_objects);
}

// site.idl

void fields(auto& v, Of<SiteDescription> auto& m, auto& w) {
    const Range place = within(kMaxCoordinate_m);
    v.key("SiteDescription.site", m.site, w.site, Text::kName);
    v("SiteDescription.cameras", m.cameras, w.cameras, AtMost{kMaxCamerasPerSite});
    v.rule("SiteDescription.bounds_site", !m.bounds_site.empty(), "is empty");
    v("SiteDescription.bounds_site", m.bounds_site.min, w.bounds_min, place);
    v("SiteDescription.bounds_site", m.bounds_site.max, w.bounds_max, place);
}

void fields(auto& v, Of<SiteMesh> auto& m, auto& w) {
    v.key("SiteMesh.site", m.site, w.site, Text::kName);
    v(m.frame_id, w.frame_id);
    v("SiteMesh.capture_time", m.capture_time, w.capture_time_ns);
    v("SiteMesh.textured_cameras", m.textured_cameras, w.textured_cameras, CameraSet{});
    v("SiteMesh.draco", m.draco, w.draco, AtMost{kMaxCodedBytes});
    v("SiteMesh.mesh_sizes", m.mesh_sizes, w.mesh_sizes, PartSizes{kMaxRegions, m.draco.size()});
    const EachOrNone frames{m.textured_cameras.size()};
    v("SiteMesh.texture_frames", m.texture_frames, w.texture_frames, frames);
}

void fields(auto& v, Of<CameraTexture> auto& m, auto& w) {
    v.key("CameraTexture.site", m.site, w.site, Text::kName);
    v.key("CameraTexture.camera", m.camera, w.camera, Range{0, kMaxCamerasPerSite - 1});
    v(m.frame_id, w.frame_id);
    v("CameraTexture.capture_time", m.capture_time, w.capture_time_ns);
    auto& crop = m.crop_px;
    v("CameraTexture.crop_px.x", crop.x, w.crop_x, Range{0, kMaxImageSide_px});
    v("CameraTexture.crop_px.y", crop.y, w.crop_y, Range{0, kMaxImageSide_px});
    // In double: the sum of two hostile integers may not fit.
    const Range width{1, kMaxImageSide_px - double{1} * crop.x};
    const Range height{1, kMaxImageSide_px - double{1} * crop.y};
    v("CameraTexture.crop_px.width", crop.width, w.crop_width, width);
    v("CameraTexture.crop_px.height", crop.height, w.crop_height, height);
    v("CameraTexture.colour", m.colour, w.colour, AtMost{kMaxCodedBytes});
    v("CameraTexture.mask", m.mask, w.mask, AtMost{kMaxCodedBytes});
}

// world.idl

void fields(auto& v, Of<SitePlacement> auto& m, auto& w) {
    v.key("SitePlacement.site", m.site, w.site, Text::kName);
    v("SitePlacement.world_from_site", m.world_from_site, w.world_from_site);
}

void fields(auto& v, Of<SceneObject> auto& m, auto& w) {
    v.key("SceneObject.object", m.object, w.object);
    v("SceneObject.name", m.name, w.name, Text::kName);
    v("SceneObject.shape", m.shape, w.shape, Last{Shape::kSoft});
    v("SceneObject.size_m", m.size_m, w.size_m, Sizes{m.shape});
    v("SceneObject.mass_kg", m.mass_kg, w.mass_kg, Range{0, kMaxMass_kg});
    v("SceneObject.friction", m.friction, w.friction, Range{0, kMaxFriction});
    v("SceneObject.restitution", m.restitution, w.restitution, Range{0, 1});
    v("SceneObject.colour", m.colour, w.colour, Range{0, 1});
    v("SceneObject.model", m.model, w.model, Text::kModelFileOrNone);
    const bool is_model = m.shape == Shape::kConvex || m.shape == Shape::kCompound;
    v.rule(
        "SceneObject.model", !is_model || !m.model.empty(), "a convex or compound shape needs one");
    v("SceneObject.model_scale", m.model_scale, w.model_scale, Positive{kMaxModelScale});
    v("SceneObject.texture", m.texture, w.texture, Text::kModelFileOrNone);
    v.part(m.model_fingerprint, w.model_fingerprint);
    v.part(m.texture_fingerprint, w.texture_fingerprint);
    v("SceneObject.world_from_object", m.world_from_object, w.world_from_object);
}

void fields(auto& v, Of<SoftBody> auto& m, auto& w) {
    v.key("SoftBody.object", m.object, w.object);
    v("SoftBody.num_nodes", m.num_nodes, w.num_nodes, AtMost{kMaxSoftNodes});
    v("SoftBody.thickness_m", m.thickness_m, w.thickness_m, Range{0, kMaxThickness_m});
    const Indices of_triangles{kMaxSoftTriangles, m.num_nodes};
    const Indices of_segments{kMaxSoftSegments, m.num_nodes};
    v("SoftBody.triangles", m.triangles, w.triangles, of_triangles);
    v("SoftBody.segments", m.segments, w.segments, of_segments);
}

void fields(auto& v, Of<SoftBodyState> auto& m, auto& w) {
    v.key("SoftBodyState.object", m.object, w.object);
    v(m.tick, w.tick);
    v("SoftBodyState.time", m.time, w.time_ns);
    v("SoftBodyState.origin_m", m.origin_m, w.origin_m, within(kMaxCoordinate_m));
    v("SoftBodyState.step_m", m.step_m, w.step_m, Positive{kMaxSoftStep_m});
    v("SoftBodyState.nodes", m.nodes, w.nodes, AtMost{kMaxSoftNodes});
}

void fields(auto& v, Of<Scenery> auto& m, auto& w) {
    v.key("Scenery.name", m.name, w.name, Text::kName);
    v("Scenery.model", m.model, w.model, Text::kModelFile);
    v("Scenery.model_scale", m.model_scale, w.model_scale, Positive{kMaxModelScale});
    v("Scenery.texture", m.texture, w.texture, Text::kModelFileOrNone);
    v.part(m.model_fingerprint, w.model_fingerprint);
    v.part(m.texture_fingerprint, w.texture_fingerprint);
    v("Scenery.colour", m.colour, w.colour, Range{0, 1});
    v("Scenery.world_from_model", m.world_from_model, w.world_from_model);
}

void fields(auto& v, Of<SceneState> auto& m, auto& w) {
    v.key("SceneState.world", m.world, w.world, Text::kName);
    v(m.tick, w.tick);
    v("SceneState.time", m.time, w.time_ns);
    v("SceneState.objects", m.objects, w.objects, AtMost{kMaxObjects});
}

void fields(auto& v, Of<SceneCommand> auto& m, auto& w) {
    const Range place = within(kMaxCoordinate_m);
    v.key("SceneCommand.sender", m.sender, w.sender, Text::kName);
    v("SceneCommand.kind", m.kind, w.kind, Last{CommandKind::kRestore});
    v(m.target, w.target);
    v("SceneCommand.impulse_ns", m.impulse_ns, w.impulse_ns, within(kMaxMass_kg));
    v("SceneCommand.point_object", m.point_object, w.point_object, place);
    v("SceneCommand.goal_world", m.goal_world, w.goal_world, place);
    if (m.kind == CommandKind::kAdd || v.kWithUnused) v.part(m.object, w.object);
}

// editing.idl

void fields(auto& v, Of<SceneEdit> auto& m, auto& w) {
    v.key("SceneEdit.sender", m.sender, w.sender, Text::kName);
    v("SceneEdit.kind", m.kind, w.kind, Last{EditKind::kLoadWorld});
    v(m.number, w.number);
    v(m.target, w.target);
    v(m.revision, w.revision);
    v("SceneEdit.world_file", m.world_file, w.world_file, Text::kNameOrNone);
    v("SceneEdit.world_from_object", m.world_from_object, w.world_from_object);
    if (has_object(m.kind) || v.kWithUnused) v.part(m.object, w.object);
}

void fields(auto& v, Of<EditResult> auto& m, auto& w) {
    v.key("EditResult.sender", m.sender, w.sender, Text::kName);
    v(m.number, w.number);
    v("EditResult.is_done", m.is_done, w.is_done);
    v(m.object, w.object);
    v(m.revision, w.revision);
    v("EditResult.text", m.text, w.text, Text::kLine);
}

void fields(auto& v, Of<SavedWorlds> auto& m, auto& w) {
    v.key("SavedWorlds.world", m.world, w.world, Text::kName);
    v("SavedWorlds.is_on", m.is_on, w.is_on);
    v("SavedWorlds.worlds", m.worlds, w.worlds, AtMost{kMaxSavedWorlds});
}

// recording.idl

void fields(auto& v, Of<RoomRecordOrder> auto& m, auto& w) {
    v.key("RoomRecordOrder.sender", m.sender, w.sender, Text::kName);
    v("RoomRecordOrder.site", m.site, w.site, Text::kName);
    v(m.number, w.number);
    v("RoomRecordOrder.kind", m.kind, w.kind, Last{RecordOrderKind::kStop});
    v("RoomRecordOrder.folder", m.folder, w.folder, Text::kNameOrNone);
}

void fields(auto& v, Of<RoomRecording> auto& m, auto& w) {
    v.key("RoomRecording.site", m.site, w.site, Text::kName);
    v("RoomRecording.time", m.time, w.time_ns);
    v("RoomRecording.state", m.state, w.state, Last{RoomRecordingState::kEnded});
    v("RoomRecording.sender", m.sender, w.sender, Text::kNameOrNone);
    v(m.number, w.number);
    v("RoomRecording.is_refused", m.is_refused, w.is_refused);
    v("RoomRecording.text", m.text, w.text, Text::kLine);
    v("RoomRecording.seconds", m.seconds, w.seconds, kStatistic);
    v(m.num_pictures, w.num_pictures);
    v(m.num_dropped, w.num_dropped);
    v(m.num_bytes, w.num_bytes);
}

// proxy.idl

void fields(auto& v, Of<PersonProxy> auto& m, auto& w) {
    v.key("PersonProxy.site", m.site, w.site, Text::kName);
    v("PersonProxy.capture_time", m.capture_time, w.capture_time_ns);
    v(m.num_surfels, w.num_surfels);
    v("PersonProxy.origin_m", m.origin_m, w.origin_m, within(kMaxCoordinate_m));
    v("PersonProxy.step_m", m.step_m, w.step_m, Positive{kMaxProxyStep_m});
    v("PersonProxy.points", m.points, w.points, AtMost{kMaxProxyPoints});
    v("PersonProxy.touches", m.touches, w.touches, AtMost{kMaxTouches});
}

void fields(auto& v, Of<ObjectProxy> auto& m, auto& w) {
    v.key("ObjectProxy.object", m.object, w.object);
    v("ObjectProxy.origin_m", m.origin_m, w.origin_m, within(kMaxCoordinate_m));
    v("ObjectProxy.step_m", m.step_m, w.step_m, Positive{kMaxProxyStep_m});
    v("ObjectProxy.vertices", m.vertices, w.vertices, AtMost{kMaxProxyVertices});
    v("ObjectProxy.edges", m.edges, w.edges, Indices{kMaxProxyEdges, m.vertices.size()});
}

// feedback.idl

void fields(auto& v, Of<StreamFeedback> auto& m, auto& w) {
    const Range delay = within(kMaxStatistic);
    v.key("StreamFeedback.viewer", m.viewer, w.viewer, Text::kName);
    v.key("StreamFeedback.site", m.site, w.site, Text::kName);
    v("StreamFeedback.time", m.time, w.time_ns);
    v(m.newest_frame_id, w.newest_frame_id);
    v(m.num_complete, w.num_complete);
    v(m.num_incomplete, w.num_incomplete);
    v(m.num_late, w.num_late);
    v(m.num_samples, w.num_samples);
    v("StreamFeedback.payload_bytes_per_s",
      m.payload_bytes_per_s,
      w.payload_bytes_per_s,
      kStatistic);
    v("StreamFeedback.delay_ms", m.min_delay_ms, w.min_delay_ms, delay);
    v("StreamFeedback.delay_ms", m.sure_delay_ms, w.sure_delay_ms, delay);
    v("StreamFeedback.delay_ms", m.median_delay_ms, w.median_delay_ms, delay);
    v("StreamFeedback.longest_wait_ms", m.longest_wait_ms, w.longest_wait_ms, kStatistic);
}

// presence.idl

void fields(auto& v, Of<Presence> auto& m, auto& w) {
    v.key("Presence.kind", m.kind, w.kind, Last{ProgramKind::kRegionNode});
    v.key("Presence.name", m.name, w.member, Text::kName);
    v.key("Presence.instance", m.instance, w.instance);
    v("Presence.is_holder", m.is_holder, w.is_holder);
    v(m.num_written, w.num_written);
    v("Presence.host", m.host, w.host, Text::kName);
    v(m.pid, w.pid);
    v("Presence.version", m.version, w.version, Text::kName);
    v("Presence.start_time", m.start_time, w.start_time_ns);
    v("Presence.is_clock_synchronised", m.is_clock_synchronised, w.is_clock_synchronised);
    v("Presence.clock_max_error", m.clock_max_error, w.clock_max_error_ns);
}

void fields(auto& v, Of<RevokedKeys> auto& m, auto& w) {
    v.key("RevokedKeys.sender", m.sender, w.sender, Text::kName);
    v("RevokedKeys.crl", m.crl, w.crl, AtMost{kMaxRevocationBytes});
}

}  // namespace atrium::bus
