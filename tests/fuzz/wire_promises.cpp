#include "tests/fuzz/wire_promises.hpp"

#include "core/bus/limits.hpp"

#include <algorithm>
#include <set>

namespace atrium::test {
namespace {

std::string unless(bool holds, const char* what) { return holds ? "" : what; }

bool is_picture_side(int pixels) { return pixels >= 1 && pixels <= bus::kMaxImageSide_px; }

std::string broken_by_process(const ProcessorUse& use, double first_output_s) {
    for (const double value : {use.run_per_s, use.waited_per_s, use.longest_wait_per_s}) {
        if (value < 0.0) return "a share";
    }
    if (use.nice < -20 || use.nice > 19) return "a niceness";
    return unless(first_output_s >= 0.0, "a time");
}

std::string broken_by_coherence(const bus::RigCoherence& coherence) {
    if (coherence.verdict > bus::RigVerdict::kLenses) return "a verdict";
    if (coherence.cameras.size() > bus::kMaxCamerasPerSite) return "too many cameras of a rig";
    for (const bus::CameraCoherence& camera : coherence.cameras) {
        if (camera.rms_px < 0.0 || camera.share < 0.0 || camera.share > 1.0) return "a camera";
    }
    const bus::RigFault& fault = coherence.fault;
    if (coherence.has_fault() && fault.camera >= coherence.cameras.size()) return "no camera";
    for (const double value : {fault.turned_deg, fault.moved_mm}) {
        if (value < 0.0 && value != -1.0) return "a motion";
    }
    return unless(coherence.rms_px >= 0.0 && fault.effect_px >= 0.0, "an error");
}

}  // namespace

std::string broken_promise(const bus::SiteDescription& message) {
    if (message.cameras.size() > bus::kMaxCamerasPerSite) return "too many cameras";
    for (const geometry::CalibratedCamera& camera : message.cameras) {
        const geometry::PinholeCamera& intrinsics = camera.intrinsics;
        if (!is_picture_side(intrinsics.width) || !is_picture_side(intrinsics.height))
            return "a picture's size";
        if (!(intrinsics.fx > 0.0 && intrinsics.fy > 0.0)) return "a focal length";
    }
    const geometry::Aabb& bounds = message.bounds_site;
    return unless((bounds.min.array() <= bounds.max.array()).all(), "the bounds");
}

std::string broken_promise(const bus::SiteMesh& message) {
    const auto& cameras = message.textured_cameras;
    const std::set<std::uint32_t> distinct(cameras.begin(), cameras.end());
    if (distinct.size() != cameras.size()) return "a camera twice";
    if (!distinct.empty() && *distinct.rbegin() >= bus::kMaxCamerasPerSite)
        return "a camera's index";
    const std::size_t num_frames = message.texture_frames.size();
    if (num_frames != 0 && num_frames != cameras.size()) return "a texture's frame";
    std::uint64_t num_bytes = 0;
    for (const std::uint32_t size : message.mesh_sizes) num_bytes += size;
    if (!message.mesh_sizes.empty() && num_bytes != message.draco.size()) return "a mesh's size";
    return unless(message.draco.size() <= bus::kMaxCodedBytes, "too many bytes");
}

std::string broken_promise(const bus::CameraSilhouette& message) {
    if (message.camera >= bus::kMaxCamerasPerSite) return "a camera's index";
    if (message.contour_sizes.size() > bus::kMaxContours) return "too many contours";
    std::uint64_t num_vertices = 0;
    for (const std::uint32_t size : message.contour_sizes) num_vertices += size;
    if (num_vertices != message.vertices_px.size()) return "a contour's size";
    return unless(num_vertices <= bus::kMaxContourVertices, "too many vertices");
}

std::string broken_promise(const bus::SiteOrders& message) {
    if (message.jpeg_quality < 1 || message.jpeg_quality > 100) return "a quality";
    if (message.send_every < 1 || message.send_every > bus::kMaxSendEvery) return "a share";
    return unless(message.colour_divisor == 1 || message.colour_divisor == 2, "a divisor");
}

std::string broken_promise(const bus::ClockAnswer& /*message*/) { return ""; }

std::string broken_promise(const bus::CameraNodeStatus& message) {
    if (message.cameras.size() > message.camera_indices.size()) return "too many cameras";
    if (message.silhouettes_per_s < 0.0 || message.silhouette_bytes_per_s < 0.0 ||
        message.texture_bytes_per_s < 0.0)
        return "a rate";
    return broken_by_process(message.processor, message.first_output_s);
}

std::string broken_promise(const bus::RegionOrder& message) {
    const auto& cameras = message.cameras;
    const std::set<std::uint32_t> distinct(cameras.begin(), cameras.end());
    if (distinct.size() != cameras.size()) return "a camera twice";
    if (!distinct.empty() && *distinct.rbegin() >= bus::kMaxCamerasPerSite)
        return "a camera's index";
    if (message.contour_counts.size() != cameras.size()) return "a camera without contours";
    std::uint64_t num_contours = 0;
    for (const std::uint32_t count : message.contour_counts) num_contours += count;
    if (num_contours != message.contour_sizes.size()) return "a camera's contours";
    std::uint64_t num_vertices = 0;
    for (const std::uint32_t size : message.contour_sizes) num_vertices += size;
    if (num_vertices != message.vertices_px.size()) return "a contour's size";
    return unless(num_vertices <= bus::kMaxOrderVertices, "too many vertices");
}

std::string broken_promise(const bus::RegionMeshes& message) {
    if (message.regions.size() > bus::kMaxRegions) return "too many regions";
    std::set<std::uint32_t> distinct;
    std::uint64_t num_bytes = 0;
    for (const bus::RegionHull& hull : message.regions) {
        if (hull.outcome > bus::RegionOutcome::kOtherRig) return "an outcome";
        if (hull.region >= bus::kMaxRegions || !distinct.insert(hull.region).second)
            return "a region's index";
        if ((hull.num_bytes > 0) != (hull.outcome == bus::RegionOutcome::kMesh)) return "a mesh";
        num_bytes += hull.num_bytes;
    }
    return unless(num_bytes == message.draco.size(), "a mesh's size");
}

std::string broken_promise(const bus::RegionNodeStatus& message) {
    if (message.orders_per_s < 0.0 || message.bytes_per_s < 0.0) return "a rate";
    return broken_by_process(message.processor, message.first_output_s);
}

std::string broken_promise(const bus::CameraTexture& message) {
    if (message.camera >= bus::kMaxCamerasPerSite) return "a camera's index";
    const image::PixelRect& crop = message.crop_px;
    if (crop.x < 0 || crop.y < 0 || crop.width < 1 || crop.height < 1) return "an empty crop";
    if (!is_picture_side(crop.width) || !is_picture_side(crop.height) ||
        !is_picture_side(crop.x + crop.width) || !is_picture_side(crop.y + crop.height))
        return "a crop outside of any picture";
    const std::size_t most = std::max(message.colour.size(), message.mask.size());
    return unless(most <= bus::kMaxCodedBytes, "too many bytes");
}

std::string broken_promise(const bus::SitePlacement& /*message*/) { return ""; }

std::string broken_promise(const bus::SceneObject& message) {
    if (message.shape > bus::Shape::kSoft) return "a shape";
    const bool is_simple = message.shape <= bus::Shape::kPlane;
    const int num_sizes = message.shape == bus::Shape::kPlane ? 2 : 3;
    const double least_m = message.size_m.head(num_sizes).minCoeff();
    if (is_simple ? !(least_m > 0.0) : !(least_m >= 0.0)) return "a size";
    const bool is_model =
        message.shape == bus::Shape::kConvex || message.shape == bus::Shape::kCompound;
    if (is_model && message.model.empty()) return "no model";
    if (!(message.model_scale > 0.0)) return "a model's scale";
    if (!(message.friction >= 0.0 && message.restitution >= 0.0 && message.restitution <= 1.0))
        return "a material";
    if (message.mass_kg < 0.0) return "a mass";
    const auto colour = message.colour.array();
    return unless((colour >= 0.0).all() && (colour <= 1.0).all(), "a colour");
}

std::string broken_promise(const bus::SoftBody& message) {
    if (message.num_nodes > bus::kMaxSoftNodes) return "too many nodes";
    const auto is_there = [&](std::uint16_t node) { return node < message.num_nodes; };
    for (const auto& triangle : message.triangles) {
        if (!std::all_of(triangle.begin(), triangle.end(), is_there)) return "a node";
    }
    for (const auto& segment : message.segments) {
        if (!std::all_of(segment.begin(), segment.end(), is_there)) return "a node";
    }
    return unless(message.thickness_m >= 0.0, "a thickness");
}

std::string broken_promise(const bus::SoftBodyState& message) {
    if (message.nodes.size() > bus::kMaxSoftNodes) return "too many nodes";
    return unless(message.step_m > 0.0, "a step");
}

std::string broken_promise(const bus::Scenery& message) {
    if (message.model.empty()) return "no model";
    const auto colour = message.colour.array();
    if (!((colour >= 0.0).all() && (colour <= 1.0).all())) return "a colour";
    return unless(message.model_scale > 0.0, "a model's scale");
}

std::string broken_promise(const bus::SceneState& message) {
    return unless(message.objects.size() <= bus::kMaxObjects, "too many objects");
}

std::string broken_promise(const bus::PersonProxy& message) {
    if (message.points.size() > bus::kMaxProxyPoints) return "too many points";
    if (message.touches.size() > bus::kMaxTouches) return "too many touches";
    return unless(message.step_m > 0.0, "a step");
}

std::string broken_promise(const bus::ObjectProxy& message) {
    if (message.vertices.size() > bus::kMaxProxyVertices) return "too many vertices";
    for (const auto& [from, to] : message.edges) {
        if (std::max(from, to) >= message.vertices.size()) return "a vertex";
    }
    return unless(message.step_m > 0.0, "a step");
}

std::string broken_promise(const bus::SceneCommand& message) {
    if (message.kind > bus::CommandKind::kRestore) return "a kind of command";
    return message.kind == bus::CommandKind::kAdd ? broken_promise(message.object) : "";
}

std::string broken_promise(const bus::SceneEdit& message) {
    if (message.kind > bus::EditKind::kLoadWorld) return "a kind of edit";
    if (message.world_file.find('/') != std::string::npos) return "a folder in a file's name";
    return bus::has_object(message.kind) ? broken_promise(message.object) : "";
}

std::string broken_promise(const bus::EditResult& message) {
    const bool is_printable = std::all_of(
        message.text.begin(), message.text.end(), [](char c) { return c >= 0x20 && c < 0x7f; });
    return unless(is_printable && message.text.size() <= bus::kMaxTextLength, "a text");
}

std::string broken_promise(const bus::SavedWorlds& message) {
    return unless(message.worlds.size() <= bus::kMaxSavedWorlds, "too many worlds");
}

std::string broken_promise(const bus::RoomRecordOrder& message) {
    if (message.kind > bus::RecordOrderKind::kStop) return "a kind of order";
    return unless(message.folder.find('/') == std::string::npos, "a folder in a folder's name");
}

std::string broken_promise(const bus::RoomRecording& message) {
    if (message.state > bus::RoomRecordingState::kEnded) return "a state";
    const bool is_printable = std::all_of(
        message.text.begin(), message.text.end(), [](char c) { return c >= 0x20 && c < 0x7f; });
    return unless(is_printable && message.text.size() <= bus::kMaxTextLength, "a text");
}

std::string broken_promise(const bus::SiteStatus& message) {
    if (message.cameras.size() > bus::kMaxCamerasPerSite) return "too many cameras";
    for (const bus::CameraStatus& camera : message.cameras) {
        if (camera.last_picture_age_ms < 0.0 && camera.last_picture_age_ms != -1.0)
            return "a picture's age";
    }
    const bus::StreamState& stream = message.stream;
    if (stream.jpeg_quality < 1 || stream.jpeg_quality > 100) return "a quality";
    if (stream.colour_divisor != 1 && stream.colour_divisor != 2) return "a divisor";
    if (stream.send_every < 1 || stream.send_every > bus::kMaxSendEvery) return "a share";
    const bus::StageTimes& stages = message.stages;
    for (const double value : {message.left_out.dropped_l,
                               message.metaframes_per_s,
                               message.bytes_per_s,
                               message.mesh_bytes_per_s,
                               message.texture_bytes_per_s,
                               stream.cap_bit_per_s,
                               stages.silhouettes_ms,
                               stages.hull_ms,
                               stages.coding_ms,
                               stages.publishing_ms}) {
        if (value < 0.0) return "a rate or a time";
    }
    for (const bus::HostStatus& host : message.hosts) {
        if (host.state > bus::HostState::kOtherRig) return "a host's state";
        if (host.clock_error_ms < 0.0) return "a clock's error";
    }
    const std::string coherence = broken_by_coherence(message.coherence);
    if (!coherence.empty()) return coherence;
    return broken_by_process(message.processor, message.first_output_s);
}

std::string broken_promise(const bus::WorldStatus& message) {
    if (message.steps_per_s < 0.0) return "a rate";
    return broken_by_process(message.processor, message.first_output_s);
}

std::string broken_promise(const bus::ViewerStatus& message) {
    if (message.frames_per_s < 0.0 || message.max_frames_per_s < 0.0) return "a rate";
    if (message.scale < 0.0 || message.scale > 1.0) return "a scale";
    return broken_by_process(message.processor, message.first_output_s);
}

std::string broken_promise(const bus::StreamFeedback& message) {
    return unless(message.payload_bytes_per_s >= 0.0 && message.longest_wait_ms >= 0.0,
                  "a rate and a time");
}

std::string broken_promise(const bus::Presence& message) {
    return unless(message.kind <= bus::ProgramKind::kRegionNode, "a kind of program");
}

std::string broken_promise(const bus::RevokedKeys& message) {
    return unless(message.crl.size() <= bus::kMaxRevocationBytes, "a list of bounded size");
}

}  // namespace atrium::test
