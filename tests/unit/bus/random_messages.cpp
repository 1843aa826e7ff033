#include "tests/unit/bus/random_messages.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <type_traits>

namespace atrium::bus::testing {

namespace {

std::uint64_t below(Random& random, std::uint64_t end) { return random() % end; }

double number(Random& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

std::string name(Random& random) {
    constexpr std::string_view kLetters =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.-";
    std::string out(1 + below(random, 63), ' ');
    for (char& c : out) c = kLetters[below(random, kLetters.size())];
    return out;
}

std::string model_file(Random& random) {
    std::string out = "models/" + name(random);
    if (out[7] == '.') out[7] = '_';  // no part of a name begins with a dot
    return out;
}

template <std::size_t N>
std::vector<std::array<std::uint16_t, N>> groups(Random& random,
                                                 std::size_t max,
                                                 std::uint32_t end) {
    std::vector<std::array<std::uint16_t, N>> out(below(random, max));
    for (auto& group : out)
        for (auto& number : group) number = static_cast<std::uint16_t>(below(random, end));
    return out;
}

Eigen::Vector3d vector(Random& random, double limit) {
    return {number(random, -limit, limit),
            number(random, -limit, limit),
            number(random, -limit, limit)};
}

geometry::RigidTransform pose(Random& random) {
    const Eigen::Vector3d axis = vector(random, 1.0);
    return {Eigen::Quaterniond(number(random, 0.1, 1.0), axis.x(), axis.y(), axis.z()).normalized(),
            vector(random, 100.0)};
}

Timestamp time(Random& random) { return {static_cast<std::int64_t>(random() >> 2U)}; }

std::vector<std::uint8_t> bytes(Random& random) {
    std::vector<std::uint8_t> out(below(random, 5000));
    for (auto& byte : out) byte = static_cast<std::uint8_t>(random());
    return out;
}

LatencySummary latency(Random& random) {
    return {number(random, 0, 100), number(random, 0, 1000), random()};
}

std::vector<CameraStatus> camera_statuses(Random& random) {
    std::vector<CameraStatus> out(2 + below(random, 63));
    for (CameraStatus& camera : out) {
        camera = {name(random),
                  below(random, 2) == 0,
                  random(),
                  random(),
                  random(),
                  random(),
                  random(),
                  random(),
                  random(),
                  number(random, -100, 100),
                  below(random, 4) == 0 ? -1.0 : number(random, 0, 1e6)};
    }
    return out;
}

ProcessorUse processor_use(Random& random) {
    return {random(),
            random(),
            number(random, 0, 64),
            number(random, 0, 1e3),
            number(random, 0, 1),
            below(random, 2) == 0,
            static_cast<std::int16_t>(static_cast<int>(below(random, 40)) - 20)};
}

bool same(const geometry::RigidTransform& a, const geometry::RigidTransform& b) {
    return a.rotation.coeffs() == b.rotation.coeffs() && a.translation == b.translation;
}

bool same(const geometry::CalibratedCamera& a, const geometry::CalibratedCamera& b) {
    const auto& p = a.intrinsics;
    const auto& q = b.intrinsics;
    return a.name == b.name && p.width == q.width && p.height == q.height && p.fx == q.fx &&
           p.fy == q.fy && p.cx == q.cx && p.cy == q.cy && p.skew == q.skew &&
           p.distortion == q.distortion && same(a.camera_from_site, b.camera_from_site);
}

bool same(const ObjectState& a, const ObjectState& b) {
    return a.object == b.object && same(a.world_from_object, b.world_from_object) &&
           a.linear_velocity == b.linear_velocity && a.angular_velocity == b.angular_velocity;
}

bool same(const LatencySummary& a, const LatencySummary& b) {
    return a.median_ms == b.median_ms && a.p99_ms == b.p99_ms && a.num_samples == b.num_samples;
}

template <typename Element>
bool same_elements(const std::vector<Element>& a, const std::vector<Element>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
        return same(x, y);
    });
}

}  // namespace

template <>
SiteDescription random_message(Random& random) {
    SiteDescription out;
    out.site = name(random);
    out.cameras.resize(below(random, 65));
    for (auto& camera : out.cameras) {
        camera.name = name(random);
        auto& intrinsics = camera.intrinsics;
        intrinsics.width = 1 + static_cast<int>(below(random, 16384));
        intrinsics.height = 1 + static_cast<int>(below(random, 16384));
        intrinsics.fx = number(random, 1, 1e4);
        intrinsics.fy = number(random, 1, 1e4);
        intrinsics.cx = number(random, -1e4, 1e4);
        intrinsics.cy = number(random, -1e4, 1e4);
        intrinsics.skew = number(random, -1, 1);
        for (double& k : intrinsics.distortion) k = number(random, -1, 1);
        camera.camera_from_site = pose(random);
    }
    out.bounds_site.add(vector(random, 10));
    out.bounds_site.add(vector(random, 10));
    return out;
}

template <>
SiteMesh random_message(Random& random) {
    SiteMesh out;
    out.site = name(random);
    out.frame_id = random();
    out.capture_time = time(random);
    const std::uint64_t chosen = random();
    for (std::uint32_t camera = 0; camera < 64; ++camera) {
        if ((chosen >> camera & 1U) != 0) out.textured_cameras.push_back(camera);
    }
    out.draco = bytes(random);
    return out;
}

template <>
CameraTexture random_message(Random& random) {
    CameraTexture out;
    out.site = name(random);
    out.camera = static_cast<std::uint32_t>(below(random, 64));
    out.frame_id = random();
    out.capture_time = time(random);
    out.crop_px.x = static_cast<int>(below(random, 16384));
    out.crop_px.y = static_cast<int>(below(random, 16384));
    out.crop_px.width = 1 + static_cast<int>(below(random, 16384 - out.crop_px.x));
    out.crop_px.height = 1 + static_cast<int>(below(random, 16384 - out.crop_px.y));
    out.colour = bytes(random);
    out.mask = bytes(random);
    return out;
}

template <>
SitePlacement random_message(Random& random) {
    return {name(random), pose(random)};
}

template <>
SceneObject random_message(Random& random) {
    SceneObject out;
    out.object = static_cast<std::uint32_t>(random());
    out.name = name(random);
    out.shape = static_cast<Shape>(below(random, 8));
    out.friction = number(random, 0, 10);
    out.restitution = number(random, 0, 1);
    if (out.shape >= Shape::kConvex) out.model = model_file(random);
    out.model_scale = number(random, 1e-3, 100);
    if (below(random, 2) == 0) out.texture = model_file(random);
    out.size_m = vector(random, 10).cwiseAbs() + Eigen::Vector3d::Constant(1e-3);
    out.mass_kg = number(random, 0, 100);
    out.colour = vector(random, 1).cwiseAbs();
    out.world_from_object = pose(random);
    return out;
}

template <>
SoftBody random_message(Random& random) {
    SoftBody out;
    out.object = static_cast<std::uint32_t>(random());
    out.num_nodes = 1 + static_cast<std::uint32_t>(below(random, 4096));
    out.thickness_m = number(random, 0, 0.1);
    out.triangles = groups<3>(random, 2000, out.num_nodes);
    out.segments = groups<2>(random, 300, out.num_nodes);
    return out;
}

template <>
SoftBodyState random_message(Random& random) {
    SoftBodyState out;
    out.object = static_cast<std::uint32_t>(random());
    out.tick = random();
    out.time = time(random);
    out.origin_m = vector(random, 10);
    out.step_m = number(random, 1e-6, 1e-3);
    out.nodes = groups<3>(random, 2000, 65536);
    return out;
}

template <>
Scenery random_message(Random& random) {
    Scenery out;
    out.name = name(random);
    out.model = model_file(random);
    out.model_scale = number(random, 1e-3, 100);
    if (below(random, 2) == 0) out.texture = model_file(random);
    out.colour = vector(random, 1).cwiseAbs();
    out.world_from_model = pose(random);
    return out;
}

template <>
SceneState random_message(Random& random) {
    SceneState out;
    out.world = name(random);
    out.tick = random();
    out.time = time(random);
    out.objects.resize(below(random, 200));
    for (ObjectState& object : out.objects) {
        object = {static_cast<std::uint32_t>(random()),
                  pose(random),
                  vector(random, 20),
                  vector(random, 20)};
    }
    return out;
}

template <>
PersonProxy random_message(Random& random) {
    const auto triple = [&](auto& numbers) {
        for (auto& number : numbers)
            number = static_cast<std::remove_reference_t<decltype(number)>>(random());
    };
    PersonProxy out;
    out.site = name(random);
    out.capture_time = time(random);
    out.num_surfels = static_cast<std::uint32_t>(random());
    out.origin_m = vector(random, 100);
    out.step_m = number(random, 1e-6, 1e-3);
    out.points.resize(below(random, 600));
    for (ProxyPoint& point : out.points) {
        triple(point.place);
        triple(point.velocity_mmps);
        triple(point.normal);
    }
    out.touches.resize(below(random, 30));
    for (Touch& touch : out.touches)
        touch = {static_cast<std::uint32_t>(random()), vector(random, 100)};
    return out;
}

template <>
ObjectProxy random_message(Random& random) {
    ObjectProxy out;
    out.object = static_cast<std::uint32_t>(random());
    out.origin_m = vector(random, 10);
    out.step_m = number(random, 1e-6, 1e-3);
    out.vertices = groups<3>(random, 600, 65536);
    out.vertices.emplace_back();
    out.edges = groups<2>(random, 1500, static_cast<std::uint32_t>(out.vertices.size()));
    return out;
}

template <>
SceneCommand random_message(Random& random) {
    SceneCommand out;
    out.sender = name(random);
    out.kind = static_cast<CommandKind>(below(random, 9));
    out.target = static_cast<std::uint32_t>(random());
    out.impulse_ns = vector(random, 100);
    out.point_object = vector(random, 2);
    out.goal_world = vector(random, 20);
    if (out.kind == CommandKind::kAdd) out.object = random_message<SceneObject>(random);
    return out;
}

template <>
SiteStatus random_message(Random& random) {
    return {name(random),
            time(random),
            random(),
            random(),
            random(),
            random(),
            random(),
            random(),
            {random(), random(), random(), number(random, 0, 1e4), random(), random(), random()},
            random(),
            number(random, 0, 100),
            number(random, 0, 1e9),
            latency(random),
            random(),
            camera_statuses(random),
            {1 + static_cast<std::uint32_t>(below(random, 100)),
             1 + static_cast<std::uint32_t>(below(random, 2)),
             1 + static_cast<std::uint32_t>(below(random, 64)),
             number(random, 0, 1e9),
             below(random, 2) == 0 ? std::string() : name(random),
             random()},
            {number(random, 0, 1e3),
             number(random, 0, 1e3),
             number(random, 0, 1e3),
             number(random, 0, 1e3)},
            number(random, 0, 1e9),
            number(random, 0, 1e9),
            processor_use(random),
            number(random, 0, 1e4)};
}

template <>
WorldStatus random_message(Random& random) {
    return {name(random),
            time(random),
            random(),
            random(),
            random(),
            random(),
            random(),
            number(random, 0, 1000),
            latency(random),
            random(),
            random(),
            random(),
            static_cast<std::uint32_t>(random()),
            random(),
            random(),
            random(),
            random(),
            random(),
            number(random, 0, 1e9),
            latency(random),
            latency(random),
            random(),
            random(),
            random(),
            processor_use(random),
            number(random, 0, 1e4)};
}

template <>
ViewerStatus random_message(Random& random) {
    return {name(random),
            time(random),
            random(),
            random(),
            random(),
            random(),
            random(),
            number(random, 0, 1000),
            latency(random),
            random(),
            processor_use(random),
            number(random, 0, 1e4),
            number(random, 0, 1000),
            number(random, 0, 1),
            random() % 2 == 0,
            random()};
}

template <>
StreamFeedback random_message(Random& random) {
    return {name(random),
            name(random),
            time(random),
            random(),
            static_cast<std::uint32_t>(random()),
            static_cast<std::uint32_t>(random()),
            static_cast<std::uint32_t>(random()),
            static_cast<std::uint32_t>(random()),
            number(random, 0, 1e9),
            number(random, -1e6, 1e6),
            number(random, -1e6, 1e6),
            number(random, -1e6, 1e6),
            number(random, 0, 1e6)};
}

template <>
Presence random_message(Random& random) {
    return {static_cast<ProgramKind>(below(random, 4)),
            name(random),
            random(),
            below(random, 2) == 0,
            random(),
            name(random),
            static_cast<std::uint32_t>(random()),
            name(random),
            time(random),
            below(random, 2) == 0,
            std::chrono::nanoseconds(time(random).ns)};
}

bool same(const SiteDescription& a, const SiteDescription& b) {
    return a.site == b.site && same_elements(a.cameras, b.cameras) &&
           a.bounds_site.min == b.bounds_site.min && a.bounds_site.max == b.bounds_site.max;
}

bool same(const SiteMesh& a, const SiteMesh& b) {
    return a.site == b.site && a.frame_id == b.frame_id && a.capture_time == b.capture_time &&
           a.textured_cameras == b.textured_cameras && a.draco == b.draco;
}

bool same(const CameraTexture& a, const CameraTexture& b) {
    return a.site == b.site && a.camera == b.camera && a.frame_id == b.frame_id &&
           a.capture_time == b.capture_time && a.crop_px == b.crop_px && a.colour == b.colour &&
           a.mask == b.mask;
}

bool same(const SitePlacement& a, const SitePlacement& b) {
    return a.site == b.site && same(a.world_from_site, b.world_from_site);
}

bool same(const SceneObject& a, const SceneObject& b) {
    return a.object == b.object && a.name == b.name && a.shape == b.shape && a.size_m == b.size_m &&
           a.mass_kg == b.mass_kg && a.friction == b.friction && a.restitution == b.restitution &&
           a.colour == b.colour && a.model == b.model && a.model_scale == b.model_scale &&
           a.texture == b.texture && same(a.world_from_object, b.world_from_object);
}

bool same(const SoftBody& a, const SoftBody& b) {
    return a.object == b.object && a.num_nodes == b.num_nodes && a.thickness_m == b.thickness_m &&
           a.triangles == b.triangles && a.segments == b.segments;
}

bool same(const SoftBodyState& a, const SoftBodyState& b) {
    return a.object == b.object && a.tick == b.tick && a.time == b.time &&
           a.origin_m == b.origin_m && a.step_m == b.step_m && a.nodes == b.nodes;
}

bool same(const Scenery& a, const Scenery& b) {
    return a.name == b.name && a.model == b.model && a.model_scale == b.model_scale &&
           a.texture == b.texture && a.colour == b.colour &&
           same(a.world_from_model, b.world_from_model);
}

bool same(const SceneState& a, const SceneState& b) {
    return a.world == b.world && a.tick == b.tick && a.time == b.time &&
           same_elements(a.objects, b.objects);
}

bool same(const PersonProxy& a, const PersonProxy& b) {
    const auto same_touch = [](const Touch& one, const Touch& other) {
        return one.object == other.object && one.point_world == other.point_world;
    };
    return a.site == b.site && a.capture_time == b.capture_time && a.num_surfels == b.num_surfels &&
           a.origin_m == b.origin_m && a.step_m == b.step_m && a.points == b.points &&
           std::equal(
               a.touches.begin(), a.touches.end(), b.touches.begin(), b.touches.end(), same_touch);
}

bool same(const ObjectProxy& a, const ObjectProxy& b) {
    return a.object == b.object && a.origin_m == b.origin_m && a.step_m == b.step_m &&
           a.vertices == b.vertices && a.edges == b.edges;
}

bool same(const SceneCommand& a, const SceneCommand& b) {
    return a.sender == b.sender && a.kind == b.kind && a.target == b.target &&
           a.impulse_ns == b.impulse_ns && a.point_object == b.point_object &&
           a.goal_world == b.goal_world && same(a.object, b.object);
}

bool same(const SiteStatus& a, const SiteStatus& b) {
    return a.site == b.site && a.time == b.time &&
           a.num_metaframes_captured == b.num_metaframes_captured &&
           a.num_metaframes_published == b.num_metaframes_published &&
           a.num_incomplete_used == b.num_incomplete_used &&
           a.num_dropped_incomplete == b.num_dropped_incomplete &&
           a.num_dropped_late == b.num_dropped_late && a.num_failed == b.num_failed &&
           a.left_out == b.left_out && a.num_bytes_published == b.num_bytes_published &&
           a.metaframes_per_s == b.metaframes_per_s && a.bytes_per_s == b.bytes_per_s &&
           same(a.capture_to_publish, b.capture_to_publish) &&
           a.resident_bytes == b.resident_bytes && a.cameras == b.cameras && a.stream == b.stream &&
           a.stages == b.stages && a.mesh_bytes_per_s == b.mesh_bytes_per_s &&
           a.texture_bytes_per_s == b.texture_bytes_per_s && a.processor == b.processor &&
           a.first_output_s == b.first_output_s;
}

bool same(const WorldStatus& a, const WorldStatus& b) {
    return a.world == b.world && a.time == b.time && a.num_steps == b.num_steps &&
           a.num_meshes_received == b.num_meshes_received && a.num_rejected == b.num_rejected &&
           a.num_sites == b.num_sites && a.num_contacts == b.num_contacts &&
           a.steps_per_s == b.steps_per_s && same(a.capture_to_collision, b.capture_to_collision) &&
           a.resident_bytes == b.resident_bytes && a.num_objects == b.num_objects &&
           a.num_resets == b.num_resets && a.last_reset == b.last_reset &&
           a.num_skipped_ticks == b.num_skipped_ticks && a.num_refused == b.num_refused &&
           a.num_grabs == b.num_grabs && a.num_saves == b.num_saves &&
           a.num_bytes_published == b.num_bytes_published && a.bytes_per_s == b.bytes_per_s &&
           same(a.step, b.step) && same(a.prepare, b.prepare) &&
           a.num_meshes_dropped == b.num_meshes_dropped && a.state_tick == b.state_tick &&
           a.state_hash == b.state_hash && a.processor == b.processor &&
           a.first_output_s == b.first_output_s;
}

bool same(const ViewerStatus& a, const ViewerStatus& b) {
    return a.viewer == b.viewer && a.time == b.time && a.num_frames == b.num_frames &&
           a.num_pairs_shown == b.num_pairs_shown && a.num_pairs_skipped == b.num_pairs_skipped &&
           a.num_incomplete == b.num_incomplete && a.num_rejected == b.num_rejected &&
           a.frames_per_s == b.frames_per_s && same(a.capture_to_display, b.capture_to_display) &&
           a.resident_bytes == b.resident_bytes && a.processor == b.processor &&
           a.first_output_s == b.first_output_s && a.max_frames_per_s == b.max_frames_per_s &&
           a.scale == b.scale && a.has_shadows == b.has_shadows &&
           a.num_video_dropped == b.num_video_dropped;
}

bool same(const StreamFeedback& a, const StreamFeedback& b) {
    return a.viewer == b.viewer && a.site == b.site && a.time == b.time &&
           a.newest_frame_id == b.newest_frame_id && a.num_complete == b.num_complete &&
           a.num_incomplete == b.num_incomplete && a.num_late == b.num_late &&
           a.num_samples == b.num_samples && a.payload_bytes_per_s == b.payload_bytes_per_s &&
           a.min_delay_ms == b.min_delay_ms && a.sure_delay_ms == b.sure_delay_ms &&
           a.median_delay_ms == b.median_delay_ms && a.longest_wait_ms == b.longest_wait_ms;
}

bool same(const Presence& a, const Presence& b) {
    return a.kind == b.kind && a.name == b.name && a.instance == b.instance &&
           a.is_holder == b.is_holder && a.num_written == b.num_written && a.host == b.host &&
           a.pid == b.pid && a.version == b.version && a.start_time == b.start_time &&
           a.is_clock_synchronised == b.is_clock_synchronised &&
           a.clock_max_error == b.clock_max_error;
}

}  // namespace atrium::bus::testing
