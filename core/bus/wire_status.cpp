#include "core/bus/limits.hpp"
#include "core/bus/wire_fields.hpp"

namespace atrium::bus {
namespace {

constexpr std::size_t kLeftOutBytes = 7 * sizeof(std::uint64_t);

atrium_LeftOut put_left_out(const LeftOutTotals& totals) {
    return {totals.num_cameras,
            totals.num_phantoms,
            totals.num_fragments,
            totals.dropped_l,
            totals.num_contours_dropped,
            totals.num_contours_repaired,
            totals.num_regions_failed};
}

LeftOutTotals get_left_out(const atrium_LeftOut& totals) {
    return {totals.num_cameras,
            totals.num_phantoms,
            totals.num_fragments,
            totals.dropped_l,
            totals.num_contours_dropped,
            totals.num_contours_repaired,
            totals.num_regions_failed};
}

constexpr std::size_t kCameraStatusBytes = 1 + 9 * sizeof(std::uint64_t);  // without its name

void put_camera(const CameraStatus& camera, atrium_CameraStatus& out) {
    put_name(camera.name, out.name);
    out.connected = camera.connected ? 1 : 0;
    out.num_received = camera.num_received;
    out.num_incomplete = camera.num_incomplete;
    out.num_resent = camera.num_resent;
    out.num_late = camera.num_late;
    out.num_dropped = camera.num_dropped;
    out.num_backwards = camera.num_backwards;
    out.num_reconnects = camera.num_reconnects;
    out.offset_ms = camera.offset_ms;
    out.last_picture_age_ms = camera.last_picture_age_ms;
}

CameraStatus get_camera(const atrium_CameraStatus& wire) {
    return {get_name(wire.name),
            wire.connected != 0,
            wire.num_received,
            wire.num_incomplete,
            wire.num_resent,
            wire.num_late,
            wire.num_dropped,
            wire.num_backwards,
            wire.num_reconnects,
            wire.offset_ms,
            wire.last_picture_age_ms};
}

constexpr std::size_t kStreamBytes = 3 * sizeof(std::uint32_t) + 2 * sizeof(std::uint64_t);

void put_stream(const StreamState& stream, atrium_StreamState& out) {
    out.jpeg_quality = stream.jpeg_quality;
    out.colour_divisor = stream.colour_divisor;
    out.send_every = stream.send_every;
    out.cap_bit_per_s = stream.cap_bit_per_s;
    put_name(stream.cap_set_by, out.cap_set_by);
    out.num_dropped_for_rate = stream.num_dropped_for_rate;
}

StreamState get_stream(const atrium_StreamState& stream) {
    return {stream.jpeg_quality,
            stream.colour_divisor,
            stream.send_every,
            stream.cap_bit_per_s,
            get_name(stream.cap_set_by),
            stream.num_dropped_for_rate};
}

constexpr std::size_t kProcessorBytes = 5 * sizeof(std::uint64_t) + 1 + sizeof(std::int16_t);

atrium_ProcessorUse put_processor(const ProcessorUse& use) {
    return {use.run_ns,
            use.waited_ns,
            use.run_per_s,
            use.waited_per_s,
            use.longest_wait_per_s,
            static_cast<std::uint8_t>(use.is_waiting_known ? 1 : 0),
            use.nice};
}

ProcessorUse get_processor(const atrium_ProcessorUse& wire) {
    return {wire.run_ns,
            wire.waited_ns,
            wire.run_per_s,
            wire.waited_per_s,
            wire.longest_wait_per_s,
            wire.is_waiting_known != 0,
            wire.nice};
}

Expected<void> check_flag(const atrium_ProcessorUse& wire) {
    if (wire.is_waiting_known <= 1) return {};
    return make_error(ErrorKind::kInvalidData, "processor.is_waiting_known: must be 0 or 1");
}

}  // namespace

void to_wire(const SiteStatus& message, WireScratch& scratch, atrium_SiteStatus& out) {
    key_to_wire(message, out);
    out.time_ns = message.time.ns;
    out.num_metaframes_captured = message.num_metaframes_captured;
    out.num_metaframes_published = message.num_metaframes_published;
    out.num_incomplete_used = message.num_incomplete_used;
    out.num_dropped_incomplete = message.num_dropped_incomplete;
    out.num_dropped_late = message.num_dropped_late;
    out.num_failed = message.num_failed;
    out.left_out = put_left_out(message.left_out);
    out.num_bytes_published = message.num_bytes_published;
    out.metaframes_per_s = message.metaframes_per_s;
    out.bytes_per_s = message.bytes_per_s;
    out.capture_to_publish = put_latency(message.capture_to_publish);
    out.resident_bytes = message.resident_bytes;
    scratch.camera_statuses.resize(message.cameras.size());
    for (std::size_t i = 0; i < message.cameras.size(); ++i)
        put_camera(message.cameras[i], scratch.camera_statuses[i]);
    lend(scratch.camera_statuses, out.cameras);
    put_stream(message.stream, out.stream);
    out.stages = {message.stages.silhouettes_ms,
                  message.stages.hull_ms,
                  message.stages.coding_ms,
                  message.stages.publishing_ms};
    out.mesh_bytes_per_s = message.mesh_bytes_per_s;
    out.texture_bytes_per_s = message.texture_bytes_per_s;
    out.processor = put_processor(message.processor);
    out.first_output_s = message.first_output_s;
}

Expected<SiteStatus> from_wire(const atrium_SiteStatus& wire) {
    if (wire.cameras._length > kMaxCamerasPerSite) return too_many("SiteStatus.cameras");
    if (auto flag = check_flag(wire.processor); !flag) return tl::unexpected(flag.error());
    SiteStatus message;
    message.site = get_name(wire.site);
    message.time.ns = wire.time_ns;
    message.num_metaframes_captured = wire.num_metaframes_captured;
    message.num_metaframes_published = wire.num_metaframes_published;
    message.num_incomplete_used = wire.num_incomplete_used;
    message.num_dropped_incomplete = wire.num_dropped_incomplete;
    message.num_dropped_late = wire.num_dropped_late;
    message.num_failed = wire.num_failed;
    message.left_out = get_left_out(wire.left_out);
    message.num_bytes_published = wire.num_bytes_published;
    message.metaframes_per_s = wire.metaframes_per_s;
    message.bytes_per_s = wire.bytes_per_s;
    message.capture_to_publish = get_latency(wire.capture_to_publish);
    message.resident_bytes = wire.resident_bytes;
    for (const atrium_CameraStatus& camera : elements_of(wire.cameras)) {
        if (camera.connected > 1) {
            return make_error(ErrorKind::kInvalidData,
                              "SiteStatus.cameras.connected: must be 0 or 1");
        }
        message.cameras.push_back(get_camera(camera));
    }
    message.stream = get_stream(wire.stream);
    message.stages = {wire.stages.silhouettes_ms,
                      wire.stages.hull_ms,
                      wire.stages.coding_ms,
                      wire.stages.publishing_ms};
    message.mesh_bytes_per_s = wire.mesh_bytes_per_s;
    message.texture_bytes_per_s = wire.texture_bytes_per_s;
    message.processor = get_processor(wire.processor);
    message.first_output_s = wire.first_output_s;
    return checked(std::move(message));
}

void key_to_wire(const SiteStatus& message, atrium_SiteStatus& out) {
    put_name(message.site, out.site);
}

Expected<SiteStatus> key_from_wire(const atrium_SiteStatus& wire) {
    SiteStatus key;
    key.site = get_name(wire.site);
    return with_checked_name(std::move(key), key.site);
}

std::size_t payload_bytes(const SiteStatus& message) {
    std::size_t bytes = message.site.size() + 18 * sizeof(std::uint64_t) + kLeftOutBytes +
                        kLatencyBytes + kProcessorBytes + kStreamBytes +
                        message.stream.cap_set_by.size();
    for (const CameraStatus& camera : message.cameras)
        bytes += camera.name.size() + kCameraStatusBytes;
    return bytes;
}

void to_wire(const WorldStatus& message, WireScratch& /*scratch*/, atrium_WorldStatus& out) {
    key_to_wire(message, out);
    out.time_ns = message.time.ns;
    out.num_steps = message.num_steps;
    out.num_meshes_received = message.num_meshes_received;
    out.num_rejected = message.num_rejected;
    out.num_sites = message.num_sites;
    out.num_contacts = message.num_contacts;
    out.steps_per_s = message.steps_per_s;
    out.capture_to_collision = put_latency(message.capture_to_collision);
    out.resident_bytes = message.resident_bytes;
    out.num_objects = message.num_objects;
    out.num_resets = message.num_resets;
    out.last_reset = message.last_reset;
    out.num_skipped_ticks = message.num_skipped_ticks;
    out.num_refused = message.num_refused;
    out.num_grabs = message.num_grabs;
    out.num_saves = message.num_saves;
    out.num_bytes_published = message.num_bytes_published;
    out.bytes_per_s = message.bytes_per_s;
    out.step = put_latency(message.step);
    out.prepare = put_latency(message.prepare);
    out.num_meshes_dropped = message.num_meshes_dropped;
    out.state_tick = message.state_tick;
    out.state_hash = message.state_hash;
    out.processor = put_processor(message.processor);
    out.first_output_s = message.first_output_s;
}

Expected<WorldStatus> from_wire(const atrium_WorldStatus& wire) {
    if (auto flag = check_flag(wire.processor); !flag) return tl::unexpected(flag.error());
    WorldStatus message;
    message.world = get_name(wire.world);
    message.time.ns = wire.time_ns;
    message.num_steps = wire.num_steps;
    message.num_meshes_received = wire.num_meshes_received;
    message.num_rejected = wire.num_rejected;
    message.num_sites = wire.num_sites;
    message.num_contacts = wire.num_contacts;
    message.steps_per_s = wire.steps_per_s;
    message.capture_to_collision = get_latency(wire.capture_to_collision);
    message.resident_bytes = wire.resident_bytes;
    message.num_objects = wire.num_objects;
    message.num_resets = wire.num_resets;
    message.last_reset = wire.last_reset;
    message.num_skipped_ticks = wire.num_skipped_ticks;
    message.num_refused = wire.num_refused;
    message.num_grabs = wire.num_grabs;
    message.num_saves = wire.num_saves;
    message.num_bytes_published = wire.num_bytes_published;
    message.bytes_per_s = wire.bytes_per_s;
    message.step = get_latency(wire.step);
    message.prepare = get_latency(wire.prepare);
    message.num_meshes_dropped = wire.num_meshes_dropped;
    message.state_tick = wire.state_tick;
    message.state_hash = wire.state_hash;
    message.processor = get_processor(wire.processor);
    message.first_output_s = wire.first_output_s;
    return checked(std::move(message));
}

void key_to_wire(const WorldStatus& message, atrium_WorldStatus& out) {
    put_name(message.world, out.world);
}

Expected<WorldStatus> key_from_wire(const atrium_WorldStatus& wire) {
    WorldStatus key;
    key.world = get_name(wire.world);
    return with_checked_name(std::move(key), key.world);
}

std::size_t payload_bytes(const WorldStatus& message) {
    return message.world.size() + 20 * sizeof(std::uint64_t) + sizeof(std::uint32_t) +
           3 * kLatencyBytes + kProcessorBytes;
}

void to_wire(const ViewerStatus& message, WireScratch& /*scratch*/, atrium_ViewerStatus& out) {
    key_to_wire(message, out);
    out.time_ns = message.time.ns;
    out.num_frames = message.num_frames;
    out.num_pairs_shown = message.num_pairs_shown;
    out.num_pairs_skipped = message.num_pairs_skipped;
    out.num_incomplete = message.num_incomplete;
    out.num_rejected = message.num_rejected;
    out.frames_per_s = message.frames_per_s;
    out.capture_to_display = put_latency(message.capture_to_display);
    out.resident_bytes = message.resident_bytes;
    out.processor = put_processor(message.processor);
    out.first_output_s = message.first_output_s;
    out.max_frames_per_s = message.max_frames_per_s;
    out.scale = message.scale;
    out.has_shadows = message.has_shadows ? 1 : 0;
    out.num_video_dropped = message.num_video_dropped;
}

Expected<ViewerStatus> from_wire(const atrium_ViewerStatus& wire) {
    if (auto flag = check_flag(wire.processor); !flag) return tl::unexpected(flag.error());
    if (wire.has_shadows > 1)
        return make_error(ErrorKind::kInvalidData, "ViewerStatus.has_shadows: must be 0 or 1");
    ViewerStatus message;
    message.viewer = get_name(wire.viewer);
    message.time.ns = wire.time_ns;
    message.num_frames = wire.num_frames;
    message.num_pairs_shown = wire.num_pairs_shown;
    message.num_pairs_skipped = wire.num_pairs_skipped;
    message.num_incomplete = wire.num_incomplete;
    message.num_rejected = wire.num_rejected;
    message.frames_per_s = wire.frames_per_s;
    message.capture_to_display = get_latency(wire.capture_to_display);
    message.resident_bytes = wire.resident_bytes;
    message.processor = get_processor(wire.processor);
    message.first_output_s = wire.first_output_s;
    message.max_frames_per_s = wire.max_frames_per_s;
    message.scale = wire.scale;
    message.has_shadows = wire.has_shadows != 0;
    message.num_video_dropped = wire.num_video_dropped;
    return checked(std::move(message));
}

void key_to_wire(const ViewerStatus& message, atrium_ViewerStatus& out) {
    put_name(message.viewer, out.viewer);
}

Expected<ViewerStatus> key_from_wire(const atrium_ViewerStatus& wire) {
    ViewerStatus key;
    key.viewer = get_name(wire.viewer);
    return with_checked_name(std::move(key), key.viewer);
}

std::size_t payload_bytes(const ViewerStatus& message) {
    return message.viewer.size() + 12 * sizeof(std::uint64_t) + 1 + kLatencyBytes + kProcessorBytes;
}

}  // namespace atrium::bus
