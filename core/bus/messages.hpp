#pragma once

#include "core/base/processor_use.hpp"
#include "core/base/timestamp.hpp"
#include "core/geometry/aabb.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "core/geometry/rigid_transform.hpp"
#include "core/image/image.hpp"

#include <Eigen/Core>

#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

/// Defines the messages between the programs as C++ values: one struct per topic (table in
/// idl/README.md). Messages from a Reader have passed the checks of `from_wire`: finite numbers,
/// bounded sizes, indices and enumerators in range.
namespace atrium::bus {

/// The cameras and bounds of a site. Transient local, on change. Names are 1..63 characters of
/// [A-Za-z0-9_.-].
struct SiteDescription {
    std::string site;
    std::vector<geometry::CalibratedCamera> cameras;  // CameraTexture::camera indexes this
    geometry::Aabb bounds_site;                       // [m] people are seen within it
};

/// The people of a site. Every metaframe, latest only.
struct SiteMesh {
    std::string site;
    std::uint64_t frame_id = 0;  // increases by one per metaframe of the site, also dropped ones
    Timestamp capture_time;
    /// A viewer's pair is complete with the CameraTextures of these cameras and this frame_id.
    std::vector<std::uint32_t> textured_cameras;
    std::vector<std::uint8_t> draco;  // empty: nobody is in the site
};

/// The crop of one camera's picture. Every metaframe and each camera that sees somebody, latest
/// only.
struct CameraTexture {
    std::string site;
    std::uint32_t camera = 0;
    std::uint64_t frame_id = 0;
    Timestamp capture_time;
    /// Crop in the camera's full-resolution distorted picture. Coded at half resolution.
    image::PixelRect crop_px;
    std::vector<std::uint8_t> colour;
    std::vector<std::uint8_t> mask;
};

/// Where a site is in the world; the world server decides it. Transient local, on change.
struct SitePlacement {
    std::string site;
    geometry::RigidTransform world_from_site;
};

enum class Shape : std::uint8_t {
    kBox,
    kSphere,
    kCylinder,
    kCapsule,
    kPlane,
    kConvex,
    kCompound,
    kSoft
};

/// A thing in the world. Transient local, on change.
struct SceneObject {
    std::uint32_t object = 0;
    std::string name;
    Shape shape = Shape::kBox;
    /// [m] Box: full extents. Sphere: three times the diameter. Cylinder, capsule: diameter,
    /// diameter, height along local z (with a capsule's caps). Plane: full extents x, y of the
    /// drawn part, through the origin with normal +z; third unused. Convex, compound: full extents
    /// of the scaled model. Soft: full extents of its nodes at the start.
    Eigen::Vector3d size_m = Eigen::Vector3d::Ones();
    double mass_kg = 0.0;  // 0: does not move
    double friction = 0.6;
    double restitution = 0.2;
    Eigen::Vector3d colour = Eigen::Vector3d::Constant(0.7);  // linear RGB in [0, 1]
    /// Model of a convex or compound object, in the object's frame: a file in the model folder of
    /// each host (names.hpp, is_valid_model_file). Empty: none.
    std::string model;
    double model_scale = 1.0;                    // [m] per unit of the model
    std::string texture;                         // a picture in that folder; empty: none
    geometry::RigidTransform world_from_object;  // initial pose; SceneState has the current one
};

/// The drawn triangles and segments between the nodes of a soft object. Transient local, on change.
struct SoftBody {
    std::uint32_t object = 0;
    std::uint32_t num_nodes = 0;
    double thickness_m = 0.0;                             // diameter of the drawn segments
    std::vector<std::array<std::uint16_t, 3>> triangles;  // node indices; two-sided
    std::vector<std::array<std::uint16_t, 2>> segments;
};

/// The nodes of a soft object (soft_nodes.hpp). Every published step, latest only.
struct SoftBodyState {
    std::uint32_t object = 0;
    std::uint64_t tick = 0;  // equal to that of the SceneState of the same step
    Timestamp time;          // likewise
    Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();  // world
    double step_m = 1e-4;
    std::vector<std::array<std::uint16_t, 3>> nodes;  // p_world = origin_m + step_m * node
};

/// A model that is only drawn. Each viewer loads it from its model folder. Transient local, on
/// change.
struct Scenery {
    std::string name;
    std::string model;  // model, model_scale, texture, colour: as in SceneObject
    double model_scale = 1.0;
    std::string texture;
    Eigen::Vector3d colour = Eigen::Vector3d::Constant(0.7);  // if the model has none
    geometry::RigidTransform world_from_model;
};

/// A surface sample of a person in the physics. proxy_points.hpp converts it.
struct ProxyPoint {
    std::array<std::uint16_t, 3> place{};         // p_world = origin_m + step_m * place
    std::array<std::int16_t, 3> velocity_mmps{};  // [mm/s] world
    std::array<std::int16_t, 3> normal{};         // outward unit vector times 32767

    bool operator==(const ProxyPoint&) const = default;
};

/// Where a person touches a rigid object.
struct Touch {
    std::uint32_t object = 0;
    Eigen::Vector3d point_world = Eigen::Vector3d::Zero();  // [m] on the person
};

/// The physics' model of the people of a site. At most 10 Hz, latest only, and only while it has a
/// reader.
struct PersonProxy {
    std::string site;
    Timestamp capture_time;         // of the mesh that it moves to or has reached
    std::uint32_t num_surfels = 0;  // in the physics; `points` are an even subset
    Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();  // world
    double step_m = 1e-4;
    std::vector<ProxyPoint> points;
    std::vector<Touch> touches;  // of the same tick as `points`
};

/// The physics' shape of an object with a model: the edges of its convex parts. Transient local, on
/// change.
struct ObjectProxy {
    std::uint32_t object = 0;
    Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();  // in the object's frame
    double step_m = 1e-4;
    std::vector<std::array<std::uint16_t, 3>> vertices;  // p_object = origin_m + step_m * vertex
    std::vector<std::array<std::uint16_t, 2>> edges;
};

struct ObjectState {
    std::uint32_t object = 0;
    geometry::RigidTransform world_from_object;
    Eigen::Vector3d linear_velocity = Eigen::Vector3d::Zero();   // [m/s] world
    Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // [rad/s] world
};

/// The state of all rigid objects. Every published step, latest only.
struct SceneState {
    std::string world;
    std::uint64_t tick = 0;
    Timestamp time;  // scheduled time of the tick
    std::vector<ObjectState> objects;
};

/// How a site's stream arrives at a viewer. 5 Hz, from each viewer to each site that it receives.
/// Counts and rates are since the previous sample.
struct StreamFeedback {
    std::string viewer;
    std::string site;
    Timestamp time;
    std::uint64_t newest_frame_id = 0;  // newest with complete mesh and textures; 0: none yet
    std::uint32_t num_complete = 0;     // complete frames
    std::uint32_t num_incomplete = 0;   // frames still incomplete when a newer one was complete
    std::uint32_t num_late = 0;         // samples of frames not newer than a complete one
    std::uint32_t num_samples = 0;      // received meshes and textures
    double payload_bytes_per_s = 0.0;   // of those samples
    /// Delays compare the clocks of two hosts: they can be negative, and only changes are
    /// meaningful.
    double min_delay_ms = 0.0;   // smallest of any sample, from write to take; 0 without samples
    double sure_delay_ms = 0.0;  // part of it that was certainly not a wait in the viewer's host
    /// Median from capture to the completion of a frame; without complete frames, the smallest of
    /// any sample.
    double median_delay_ms = 0.0;
    /// Longest time that a sample can have waited in the viewer's host.
    double longest_wait_ms = 0.0;
};

enum class CommandKind : std::uint8_t {
    kAdd,
    kRemove,
    kReset,
    kPush,
    kGrab,     // grab an object at a point; repeated: at another point
    kMove,     // move the goal of the grabbed point; also keeps the grab alive
    kRelease,  // release the object
    kSave,     // save the state of the world to the server's file
    kRestore   // restore it from that file
};

/// A request to the world server. On demand, reliable. `object` is used by kAdd, `target` by
/// kRemove, kPush, kGrab, kMove and kRelease.
struct SceneCommand {
    std::string sender;
    CommandKind kind = CommandKind::kReset;
    std::uint32_t target = 0;
    /// kPush: impulse [N s] in the world, applied at the centre of mass.
    Eigen::Vector3d impulse_ns = Eigen::Vector3d::Zero();
    /// kGrab: grabbed point [m], in the object's frame; of a soft object in the world.
    Eigen::Vector3d point_object = Eigen::Vector3d::Zero();
    /// kGrab, kMove: goal [m] of that point in the world.
    Eigen::Vector3d goal_world = Eigen::Vector3d::Zero();
    SceneObject object;
};

enum class EditKind : std::uint8_t {
    kAdd,        // add `object`
    kChange,     // give the target the properties of `object`
    kPlace,      // put the target at a pose, which also becomes its start, and let go of it
    kRemove,     // remove the target
    kHold,       // hold the target and carry it towards a pose; keeps the hold alive
    kLetGo,      // let go of the target
    kSaveWorld,  // write the world to the server's folder of saved worlds
    kLoadWorld   // replace the world by a saved one
};

/// True if an edit of that kind uses `SceneEdit::object`.
constexpr bool has_object(EditKind kind) { return kind <= EditKind::kPlace; }

/// An edit of the world. On demand, reliable. The server replies with an EditResult.
struct SceneEdit {
    static constexpr std::uint32_t kAnyRevision = 0xffffffff;

    std::string sender;
    EditKind kind = EditKind::kAdd;
    std::uint32_t number = 0;  // chosen by the sender; EditResult repeats it
    std::uint32_t target = 0;
    /// kChange, kPlace, kRemove: refused if the target has another revision.
    std::uint32_t revision = kAnyRevision;
    std::string world_file;  // kSaveWorld, kLoadWorld: name without folder and ending
    geometry::RigidTransform world_from_object;  // kPlace, kHold: pose of the target
    SceneObject object;  // kAdd: complete; kChange: new properties; kPlace: start pose
};

/// The outcome of a SceneEdit. For each edit, except for holds that are not refused.
struct EditResult {
    std::string sender;  // of the edit
    std::uint32_t number = 0;
    bool is_done = false;        // false: refused, nothing has changed
    std::uint32_t object = 0;    // target; of kAdd the new id
    std::uint32_t revision = 0;  // of that object after the edit
    std::string text;            // reason of a refusal, at most 255 printable ASCII characters
};

/// A world in the server's folder of saved worlds.
struct SavedWorld {
    std::string name;
    Timestamp time;  // when it was saved
    std::uint32_t num_objects = 0;
};

/// The worlds that a server can load. Transient local, on change.
struct SavedWorlds {
    std::string world;
    bool is_on = false;  // the server has a folder of saved worlds
    std::vector<SavedWorld> worlds;
};

struct LatencySummary {
    double median_ms = 0.0;
    double p99_ms = 0.0;
    std::uint64_t num_samples = 0;
};

/// Counts of omissions and repairs in hulls, over all metaframes with a hull.
struct LeftOutTotals {
    std::uint64_t num_cameras = 0;            // cameras without a picture
    std::uint64_t num_phantoms = 0;           // dropped components that no silhouette needs
    std::uint64_t num_fragments = 0;          // dropped components that are too small
    double dropped_l = 0.0;                   // volume of both [l], up to kMaxStatistic
    std::uint64_t num_contours_dropped = 0;   // too small or not repairable
    std::uint64_t num_contours_repaired = 0;  // self-crossings removed
    std::uint64_t num_regions_failed = 0;     // in hulls of which other regions succeeded

    bool operator==(const LeftOutTotals&) const = default;
};

/// Counters of one camera's pictures.
struct CameraStatus {
    std::string name;
    bool connected = false;
    std::uint64_t num_received = 0;    // complete pictures
    std::uint64_t num_incomplete = 0;  // with missing packets, or unreadable
    std::uint64_t num_resent = 0;      // packets
    std::uint64_t num_late = 0;        // replaced by a newer picture before they were taken
    std::uint64_t num_dropped = 0;     // all buffers were in use
    std::uint64_t num_backwards = 0;   // older than the previous picture
    std::uint64_t num_reconnects = 0;
    double offset_ms = 0.0;             // learned offset of its times from the other cameras'
    double last_picture_age_ms = -1.0;  // since the last complete picture; -1: none yet

    bool operator==(const CameraStatus&) const = default;
};

/// How a site currently adapts its stream to the networks of its viewers.
struct StreamState {
    std::uint32_t jpeg_quality = 85;
    std::uint32_t colour_divisor = 1;  // 1: colours at the mask's size; 2: half as wide and high
    std::uint32_t send_every = 1;      // one of n metaframes is sent
    double cap_bit_per_s = 0.0;        // 0: none
    std::string cap_set_by;            // the viewer or option that sets the cap; empty: none
    std::uint64_t num_dropped_for_rate = 0;  // metaframes dropped to stay below the cap

    bool operator==(const StreamState&) const = default;
};

/// Medians of a site's stages over its last metaframes [ms]; 0: none yet.
struct StageTimes {
    double silhouettes_ms = 0.0;  // segmentation and polygons of all cameras
    double hull_ms = 0.0;
    double coding_ms = 0.0;      // mesh and textures
    double publishing_ms = 0.0;  // handing all samples of a metaframe to the network

    bool operator==(const StageTimes&) const = default;
};

/// The state of a site node. 1 Hz. Counters start with the program.
struct SiteStatus {
    std::string site;
    Timestamp time;
    std::uint64_t num_metaframes_captured = 0;
    std::uint64_t num_metaframes_published = 0;
    std::uint64_t num_incomplete_used = 0;     // used without the pictures of some cameras
    std::uint64_t num_dropped_incomplete = 0;  // pictures were missing at the deadline
    std::uint64_t num_dropped_late = 0;        // replaced by a newer one before processing
    std::uint64_t num_failed = 0;              // a stage reported an error
    LeftOutTotals left_out;
    std::uint64_t num_bytes_published = 0;
    double metaframes_per_s = 0.0;
    double bytes_per_s = 0.0;
    LatencySummary capture_to_publish;
    std::uint64_t resident_bytes = 0;
    std::vector<CameraStatus> cameras;  // in the order of SiteDescription
    StreamState stream;
    StageTimes stages;
    double mesh_bytes_per_s = 0.0;     // part of bytes_per_s
    double texture_bytes_per_s = 0.0;  // part of bytes_per_s
    ProcessorUse processor;
    double first_output_s = 0.0;  // from process start to the first metaframe; 0: none yet
};

/// The state of a world server. 1 Hz. Counters start with the program.
struct WorldStatus {
    std::string world;
    Timestamp time;
    std::uint64_t num_steps = 0;
    std::uint64_t num_meshes_received = 0;
    std::uint64_t num_rejected = 0;  // samples that failed a check
    std::uint64_t num_sites = 0;     // present now
    std::uint64_t num_contacts = 0;  // steps with a contact between a person and an object
    double steps_per_s = 0.0;
    LatencySummary capture_to_collision;  // capture_time to the step that first used the mesh
    std::uint64_t resident_bytes = 0;
    std::uint64_t num_objects = 0;  // present now, soft ones included
    std::uint64_t num_resets = 0;   // resets by a guard: state not finite or out of the world
    std::uint32_t last_reset = 0;   // object of the last such reset; 0: none
    std::uint64_t num_skipped_ticks = 0;
    std::uint64_t num_refused = 0;  // refused commands; part of num_rejected
    std::uint64_t num_grabs = 0;    // present now
    std::uint64_t num_saves = 0;    // saved states
    std::uint64_t num_bytes_published = 0;
    double bytes_per_s = 0.0;
    LatencySummary step;                   // computation of one tick
    LatencySummary prepare;                // from taking a mesh until the step can use it
    std::uint64_t num_meshes_dropped = 0;  // replaced by a newer one before preparation
    std::uint64_t state_tick = 0;          // tick of state_hash; 0: not hashed yet
    std::uint64_t state_hash = 0;          // hash of the state after state_tick
    ProcessorUse processor;
    double first_output_s = 0.0;  // from process start to the first published state; 0: none yet
};

/// The state of a viewer. 1 Hz. Counters start with the program.
struct ViewerStatus {
    std::string viewer;
    Timestamp time;
    std::uint64_t num_frames = 0;         // drawn pictures
    std::uint64_t num_pairs_shown = 0;    // complete pairs of mesh and textures shown on screen
    std::uint64_t num_pairs_skipped = 0;  // complete pairs replaced by a newer one before drawing
    std::uint64_t num_incomplete = 0;     // pairs incomplete when a newer one was complete
    std::uint64_t num_rejected = 0;       // samples that failed a check
    double frames_per_s = 0.0;
    LatencySummary capture_to_display;
    std::uint64_t resident_bytes = 0;
    ProcessorUse processor;
    double first_output_s = 0.0;          // from process start to the first picture; 0: none yet
    double max_frames_per_s = 0.0;        // current limit [Hz]; 0: does not draw yet
    double scale = 0.0;                   // of the picture's sides, in [0, 1]; 0: does not draw yet
    bool has_shadows = false;             // draws shadows now
    std::uint64_t num_video_dropped = 0;  // dropped; the video repeats the previous picture
};

enum class ProgramKind : std::uint8_t { kSiteNode, kWorldServer, kViewer, kOther };

/// A process present in the world. Transient local, at its start and every ten seconds.
struct Presence {
    ProgramKind kind = ProgramKind::kOther;
    std::string name;            // of the site, world or viewer
    std::uint64_t instance = 0;  // random, unique per process
    bool is_holder = false;      // true: holds the name; false: still claims it
    std::uint64_t num_written = 0;
    std::string host;
    std::uint32_t pid = 0;
    std::string version;
    Timestamp start_time;
    bool is_clock_synchronised = false;  // according to the host's kernel (adjtimex)
    std::chrono::nanoseconds clock_max_error{0};
};

}  // namespace atrium::bus
