#include "core/bus/checks.hpp"

#include "core/bus/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

namespace atrium::bus {

namespace {

/// Records the first error of a message. Formats text only for an error.
class Checker {
public:
    void name(std::string_view field, std::string_view value) {
        if (!is_valid_name(value)) fail(field, "must have 1 to 63 characters of [A-Za-z0-9_.-]");
    }
    void model_file(std::string_view field, std::string_view value) {
        if (!is_valid_model_file(value)) {
            fail(field,
                 "must be a relative path of 1 to 127 characters of [A-Za-z0-9_.-/] without a "
                 "component that is empty or begins with a dot");
        }
    }
    // Every comparison of numbers is false for NaN, which thus fails the check.
    void range(std::string_view field, double value, double low, double high) {
        if (!(value >= low && value <= high))
            fail(field, fmt::format("must be in [{}, {}], got {}", low, high, value));
    }
    void positive(std::string_view field, double value, double high) {
        if (!(value > 0.0 && value <= high))
            fail(field, fmt::format("must be in (0, {}], got {}", high, value));
    }
    void vector(std::string_view field, const Eigen::Vector3d& value, double limit) {
        for (const double component : value) range(field, component, -limit, limit);
    }
    void count(std::string_view field, std::size_t value, std::size_t max) {
        if (value > max) fail(field, fmt::format("at most {}, got {}", max, value));
    }
    void time(std::string_view field, Timestamp value) {
        if (value.ns < 0 || value.ns > kMaxTime_ns)
            fail(field, fmt::format("must be in [0, 2^62] ns, got {}", value.ns));
    }
    void pose(std::string_view field, const geometry::RigidTransform& value) {
        if (!(std::abs(value.rotation.norm() - 1.0) <= kQuaternionTolerance))
            fail(field, "rotation must be a unit quaternion");
        vector(field, value.translation, kMaxCoordinate_m);
    }
    template <typename Enumerator>
    void enumerator(std::string_view field, Enumerator value, Enumerator last) {
        if (value > last)
            fail(field, fmt::format("unknown value {}", static_cast<unsigned>(value)));
    }
    void latency(std::string_view field, const LatencySummary& value) {
        // negative if the capturing host's clock is ahead of the measuring host's
        range(field, value.median_ms, -kMaxStatistic, kMaxStatistic);
        range(field, value.p99_ms, -kMaxStatistic, kMaxStatistic);
    }
    template <std::size_t N>
    void indices(std::string_view field,
                 const std::array<std::uint16_t, N>& values,
                 std::uint32_t end) {
        for (const std::uint16_t value : values)
            if (value >= end) fail(field, fmt::format("index {} of {}", value, end));
    }
    void fail(std::string_view field, std::string_view why) {
        if (fault_.empty()) fault_ = fmt::format("{}: {}", field, why);
    }
    Expected<void> result() const {
        if (!fault_.empty()) return make_error(ErrorKind::kInvalidData, fault_);
        return {};
    }

private:
    std::string fault_;
};

void check_camera(const geometry::CalibratedCamera& camera, Checker& checker) {
    checker.name("SiteDescription.cameras.name", camera.name);
    const geometry::PinholeCamera& intrinsics = camera.intrinsics;
    checker.range("SiteDescription.cameras.width", intrinsics.width, 1, kMaxImageSide_px);
    checker.range("SiteDescription.cameras.height", intrinsics.height, 1, kMaxImageSide_px);
    checker.positive("SiteDescription.cameras.fx", intrinsics.fx, kMaxIntrinsic);
    checker.positive("SiteDescription.cameras.fy", intrinsics.fy, kMaxIntrinsic);
    for (const double value : {intrinsics.cx, intrinsics.cy, intrinsics.skew})
        checker.range("SiteDescription.cameras.cx cy skew", value, -kMaxIntrinsic, kMaxIntrinsic);
    for (const double value : intrinsics.distortion)
        checker.range("SiteDescription.cameras.distortion", value, -kMaxIntrinsic, kMaxIntrinsic);
    checker.pose("SiteDescription.cameras.camera_from_site", camera.camera_from_site);
}

void check_camera(const CameraStatus& camera, Checker& checker) {
    checker.name("SiteStatus.cameras.name", camera.name);
    checker.range("SiteStatus.cameras.offset_ms", camera.offset_ms, -kMaxStatistic, kMaxStatistic);
    const double age_ms = camera.last_picture_age_ms;
    if (age_ms != -1.0)
        checker.range("SiteStatus.cameras.last_picture_age_ms", age_ms, 0.0, kMaxStatistic);
}

void check_object(const SceneObject& object, Checker& checker) {
    checker.name("SceneObject.name", object.name);
    checker.enumerator("SceneObject.shape", object.shape, Shape::kSoft);
    // A plane has only two sizes. Models and soft objects may be flat: checked below.
    const int num_sizes = object.shape == Shape::kPlane ? 2 : 3;
    for (int i = 0; i < num_sizes && object.shape < Shape::kConvex; ++i)
        checker.positive("SceneObject.size_m", object.size_m[i], kMaxCoordinate_m);
    checker.vector("SceneObject.size_m", object.size_m, kMaxCoordinate_m);
    const bool is_model = object.shape == Shape::kConvex || object.shape == Shape::kCompound;
    if (is_model && object.model.empty())
        checker.fail("SceneObject.model", "a convex or compound shape needs one");
    if (object.shape >= Shape::kConvex && object.size_m.minCoeff() < 0.0)
        checker.fail("SceneObject.size_m", "must not be negative");
    if (!object.model.empty()) checker.model_file("SceneObject.model", object.model);
    checker.positive("SceneObject.model_scale", object.model_scale, kMaxModelScale);
    if (!object.texture.empty()) checker.model_file("SceneObject.texture", object.texture);
    checker.range("SceneObject.friction", object.friction, 0.0, kMaxFriction);
    checker.range("SceneObject.restitution", object.restitution, 0.0, 1.0);
    checker.range("SceneObject.mass_kg", object.mass_kg, 0.0, kMaxMass_kg);
    for (const double component : object.colour)
        checker.range("SceneObject.colour", component, 0.0, 1.0);
    checker.pose("SceneObject.world_from_object", object.world_from_object);
}

void check_stream(const StreamState& stream, Checker& checker) {
    checker.range("SiteStatus.stream.jpeg_quality", stream.jpeg_quality, 1, 100);
    checker.range("SiteStatus.stream.colour_divisor", stream.colour_divisor, 1, 2);
    checker.range("SiteStatus.stream.send_every", stream.send_every, 1, kMaxSendEvery);
    checker.range("SiteStatus.stream.cap_bit_per_s", stream.cap_bit_per_s, 0.0, kMaxStatistic);
    if (!stream.cap_set_by.empty()) checker.name("SiteStatus.stream.cap_set_by", stream.cap_set_by);
}

void check_process(const ProcessorUse& use, double first_output_s, Checker& checker) {
    for (const double rate : {use.run_per_s, use.waited_per_s, use.longest_wait_per_s})
        checker.range("processor: seconds per second", rate, 0.0, kMaxStatistic);
    checker.range("processor.nice", use.nice, -20, 19);
    checker.range("first_output_s", first_output_s, 0.0, kMaxStatistic);
}

}  // namespace

Expected<void> check(const SiteDescription& message) {
    Checker checker;
    checker.name("SiteDescription.site", message.site);
    checker.count("SiteDescription.cameras", message.cameras.size(), kMaxCamerasPerSite);
    for (const auto& camera : message.cameras) check_camera(camera, checker);
    if (message.bounds_site.empty()) checker.fail("SiteDescription.bounds_site", "is empty");
    checker.vector("SiteDescription.bounds_site", message.bounds_site.min, kMaxCoordinate_m);
    checker.vector("SiteDescription.bounds_site", message.bounds_site.max, kMaxCoordinate_m);
    return checker.result();
}

Expected<void> check(const SiteMesh& message) {
    Checker checker;
    checker.name("SiteMesh.site", message.site);
    checker.time("SiteMesh.capture_time", message.capture_time);
    std::uint64_t seen = 0;  // one bit per camera
    static_assert(kMaxCamerasPerSite == 64);
    for (const std::uint32_t camera : message.textured_cameras) {
        const std::uint64_t bit = camera < kMaxCamerasPerSite ? std::uint64_t{1} << camera : 0;
        if (bit == 0) checker.fail("SiteMesh.textured_cameras", "index out of range");
        if ((seen & bit) != 0) checker.fail("SiteMesh.textured_cameras", "names a camera twice");
        seen |= bit;
    }
    checker.count("SiteMesh.draco bytes", message.draco.size(), kMaxCodedBytes);
    return checker.result();
}

Expected<void> check(const CameraTexture& message) {
    Checker checker;
    checker.name("CameraTexture.site", message.site);
    checker.time("CameraTexture.capture_time", message.capture_time);
    checker.range("CameraTexture.camera", message.camera, 0, kMaxCamerasPerSite - 1);
    const image::PixelRect& crop = message.crop_px;
    checker.range("CameraTexture.crop_px.x", crop.x, 0, kMaxImageSide_px);
    checker.range("CameraTexture.crop_px.y", crop.y, 0, kMaxImageSide_px);
    // In double: the sum of two hostile integers may not fit.
    checker.range(
        "CameraTexture.crop_px.width", crop.width, 1, kMaxImageSide_px - double{1} * crop.x);
    checker.range(
        "CameraTexture.crop_px.height", crop.height, 1, kMaxImageSide_px - double{1} * crop.y);
    checker.count("CameraTexture.colour bytes", message.colour.size(), kMaxCodedBytes);
    checker.count("CameraTexture.mask bytes", message.mask.size(), kMaxCodedBytes);
    return checker.result();
}

Expected<void> check(const SitePlacement& message) {
    Checker checker;
    checker.name("SitePlacement.site", message.site);
    checker.pose("SitePlacement.world_from_site", message.world_from_site);
    return checker.result();
}

Expected<void> check(const SceneObject& message) {
    Checker checker;
    check_object(message, checker);
    return checker.result();
}

Expected<void> check(const SoftBody& message) {
    Checker checker;
    checker.count("SoftBody.num_nodes", message.num_nodes, kMaxSoftNodes);
    checker.range("SoftBody.thickness_m", message.thickness_m, 0.0, kMaxThickness_m);
    checker.count("SoftBody.triangles", message.triangles.size(), kMaxSoftTriangles);
    checker.count("SoftBody.segments", message.segments.size(), kMaxSoftSegments);
    for (const auto& triangle : message.triangles)
        checker.indices("SoftBody.triangles", triangle, message.num_nodes);
    for (const auto& segment : message.segments)
        checker.indices("SoftBody.segments", segment, message.num_nodes);
    return checker.result();
}

Expected<void> check(const SoftBodyState& message) {
    Checker checker;
    checker.time("SoftBodyState.time", message.time);
    checker.vector("SoftBodyState.origin_m", message.origin_m, kMaxCoordinate_m);
    checker.positive("SoftBodyState.step_m", message.step_m, kMaxSoftStep_m);
    checker.count("SoftBodyState.nodes", message.nodes.size(), kMaxSoftNodes);
    return checker.result();
}

Expected<void> check(const Scenery& message) {
    Checker checker;
    checker.name("Scenery.name", message.name);
    checker.model_file("Scenery.model", message.model);
    checker.positive("Scenery.model_scale", message.model_scale, kMaxModelScale);
    if (!message.texture.empty()) checker.model_file("Scenery.texture", message.texture);
    for (const double component : message.colour)
        checker.range("Scenery.colour", component, 0.0, 1.0);
    checker.pose("Scenery.world_from_model", message.world_from_model);
    return checker.result();
}

Expected<void> check(const SceneState& message) {
    Checker checker;
    checker.name("SceneState.world", message.world);
    checker.time("SceneState.time", message.time);
    checker.count("SceneState.objects", message.objects.size(), kMaxObjects);
    for (const ObjectState& object : message.objects) {
        checker.pose("SceneState.objects.world_from_object", object.world_from_object);
        checker.vector("SceneState.objects.linear_velocity", object.linear_velocity, kMaxSpeed);
        checker.vector("SceneState.objects.angular_velocity", object.angular_velocity, kMaxSpeed);
    }
    return checker.result();
}

Expected<void> check(const PersonProxy& message) {
    Checker checker;
    checker.name("PersonProxy.site", message.site);
    checker.time("PersonProxy.capture_time", message.capture_time);
    checker.vector("PersonProxy.origin_m", message.origin_m, kMaxCoordinate_m);
    checker.positive("PersonProxy.step_m", message.step_m, kMaxProxyStep_m);
    checker.count("PersonProxy.points", message.points.size(), kMaxProxyPoints);
    checker.count("PersonProxy.touches", message.touches.size(), kMaxTouches);
    for (const Touch& touch : message.touches)
        checker.vector("PersonProxy.touches.point_world", touch.point_world, kMaxCoordinate_m);
    return checker.result();
}

Expected<void> check(const ObjectProxy& message) {
    Checker checker;
    checker.vector("ObjectProxy.origin_m", message.origin_m, kMaxCoordinate_m);
    checker.positive("ObjectProxy.step_m", message.step_m, kMaxProxyStep_m);
    checker.count("ObjectProxy.vertices", message.vertices.size(), kMaxProxyVertices);
    checker.count("ObjectProxy.edges", message.edges.size(), kMaxProxyEdges);
    const auto end = static_cast<std::uint32_t>(message.vertices.size());
    for (const auto& edge : message.edges) checker.indices("ObjectProxy.edges", edge, end);
    return checker.result();
}

Expected<void> check(const SceneCommand& message) {
    Checker checker;
    checker.name("SceneCommand.sender", message.sender);
    checker.enumerator("SceneCommand.kind", message.kind, CommandKind::kRestore);
    checker.vector("SceneCommand.impulse_ns", message.impulse_ns, kMaxMass_kg);
    checker.vector("SceneCommand.point_object", message.point_object, kMaxCoordinate_m);
    checker.vector("SceneCommand.goal_world", message.goal_world, kMaxCoordinate_m);
    if (message.kind == CommandKind::kAdd) check_object(message.object, checker);
    return checker.result();
}

Expected<void> check(const SiteStatus& message) {
    Checker checker;
    checker.name("SiteStatus.site", message.site);
    checker.time("SiteStatus.time", message.time);
    checker.range("SiteStatus.left_out.dropped_l", message.left_out.dropped_l, 0.0, kMaxStatistic);
    checker.range("SiteStatus.metaframes_per_s", message.metaframes_per_s, 0.0, kMaxStatistic);
    checker.range("SiteStatus.bytes_per_s", message.bytes_per_s, 0.0, kMaxStatistic);
    checker.latency("SiteStatus.capture_to_publish", message.capture_to_publish);
    checker.count("SiteStatus.cameras", message.cameras.size(), kMaxCamerasPerSite);
    for (const CameraStatus& camera : message.cameras) check_camera(camera, checker);
    check_stream(message.stream, checker);
    for (const double time_ms : {message.stages.silhouettes_ms,
                                 message.stages.hull_ms,
                                 message.stages.coding_ms,
                                 message.stages.publishing_ms})
        checker.range("SiteStatus.stages", time_ms, 0.0, kMaxStatistic);
    checker.range("SiteStatus.mesh_bytes_per_s", message.mesh_bytes_per_s, 0.0, kMaxStatistic);
    checker.range(
        "SiteStatus.texture_bytes_per_s", message.texture_bytes_per_s, 0.0, kMaxStatistic);
    check_process(message.processor, message.first_output_s, checker);
    return checker.result();
}

Expected<void> check(const WorldStatus& message) {
    Checker checker;
    checker.name("WorldStatus.world", message.world);
    checker.time("WorldStatus.time", message.time);
    checker.range("WorldStatus.steps_per_s", message.steps_per_s, 0.0, kMaxStatistic);
    checker.latency("WorldStatus.capture_to_collision", message.capture_to_collision);
    checker.range("WorldStatus.bytes_per_s", message.bytes_per_s, 0.0, kMaxStatistic);
    checker.latency("WorldStatus.step", message.step);
    checker.latency("WorldStatus.prepare", message.prepare);
    check_process(message.processor, message.first_output_s, checker);
    return checker.result();
}

Expected<void> check(const ViewerStatus& message) {
    Checker checker;
    checker.name("ViewerStatus.viewer", message.viewer);
    checker.time("ViewerStatus.time", message.time);
    checker.range("ViewerStatus.frames_per_s", message.frames_per_s, 0.0, kMaxStatistic);
    checker.latency("ViewerStatus.capture_to_display", message.capture_to_display);
    checker.range("ViewerStatus.max_frames_per_s", message.max_frames_per_s, 0.0, kMaxStatistic);
    checker.range("ViewerStatus.scale", message.scale, 0.0, 1.0);
    check_process(message.processor, message.first_output_s, checker);
    return checker.result();
}

Expected<void> check(const StreamFeedback& message) {
    Checker checker;
    checker.name("StreamFeedback.viewer", message.viewer);
    checker.name("StreamFeedback.site", message.site);
    checker.time("StreamFeedback.time", message.time);
    checker.range(
        "StreamFeedback.payload_bytes_per_s", message.payload_bytes_per_s, 0.0, kMaxStatistic);
    for (const double delay_ms :
         {message.min_delay_ms, message.sure_delay_ms, message.median_delay_ms})
        checker.range("StreamFeedback.delay_ms", delay_ms, -kMaxStatistic, kMaxStatistic);
    checker.range("StreamFeedback.longest_wait_ms", message.longest_wait_ms, 0.0, kMaxStatistic);
    return checker.result();
}

Expected<void> check(const Presence& message) {
    Checker checker;
    checker.enumerator("Presence.kind", message.kind, ProgramKind::kOther);
    checker.name("Presence.name", message.name);
    checker.name("Presence.host", message.host);
    checker.name("Presence.version", message.version);
    checker.time("Presence.start_time", message.start_time);
    checker.time("Presence.clock_max_error", {message.clock_max_error.count()});
    return checker.result();
}

}  // namespace atrium::bus
