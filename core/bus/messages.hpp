#pragma once

#include "core/base/fingerprint.hpp"
#include "core/base/timestamp.hpp"
#include "core/bus/host_messages.hpp"
#include "core/bus/status_messages.hpp"
#include "core/geometry/aabb.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "core/geometry/rigid_transform.hpp"
#include "core/image/image.hpp"
#include "core/keys/member.hpp"

#include <Eigen/Core>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
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

/// Names a picture of one camera.
struct FrameKey {
    std::uint64_t frame_id = 0;
    Timestamp capture_time;

    bool operator==(const FrameKey&) const = default;
};

/// The people of a site. Every metaframe, latest only.
struct SiteMesh {
    std::string site;
    std::uint64_t frame_id = 0;  // increases by one per metaframe of the site, also dropped ones
    Timestamp capture_time;
    /// A viewer's pair is complete with the CameraTextures of these cameras and `texture_frames`.
    std::vector<std::uint32_t> textured_cameras;
    std::vector<std::uint8_t> draco;  // one or more meshes; empty: nobody is in the site
    /// Bytes of each mesh in `draco`, in turn, where there are several: one of each region.
    std::vector<std::uint32_t> mesh_sizes{};
    /// Of `textured_cameras`, in that order: camera nodes number their own pictures. Empty: all
    /// have the frame_id and capture_time of this mesh.
    std::vector<FrameKey> texture_frames{};
};

/// Names the texture of `mesh.textured_cameras[i]`.
inline FrameKey texture_frame(const SiteMesh& mesh, std::size_t i) {
    return mesh.texture_frames.empty() ? FrameKey{mesh.frame_id, mesh.capture_time}
                                       : mesh.texture_frames[i];
}

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
    Fingerprint model_fingerprint;               // of the world server's files, for viewers to
    Fingerprint texture_fingerprint;             // compare theirs; ignored in commands and edits
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
    std::string model;  // model, model_scale, texture, fingerprints, colour: as in SceneObject
    double model_scale = 1.0;
    std::string texture;
    Fingerprint model_fingerprint;
    Fingerprint texture_fingerprint;
    Eigen::Vector3d colour = Eigen::Vector3d::Constant(0.7);  // of parts without one
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
    /// Not sent: what the sender's key allows. nullopt: in a world without keys.
    std::optional<keys::Rights> proven_rights;
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
    /// As in SceneCommand.
    std::optional<keys::Rights> proven_rights;
};

/// The outcome of a SceneEdit. For each edit, except for holds that are not refused. Without number
/// also of a SceneCommand: a grab, push or reset that was refused, or a reset.
struct EditResult {
    std::string sender;  // of the edit
    std::uint32_t number = 0;
    bool is_done = false;        // false: refused, nothing has changed
    std::uint32_t object = 0;    // target; of kAdd the new id
    std::uint32_t revision = 0;  // of that object after the edit
    std::string text;  // reason of a refusal, or news; at most 255 printable ASCII characters
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

enum class RecordOrderKind : std::uint8_t { kStart, kStop };

/// Asks a site to record its cameras, or to end that. On demand, reliable.
struct RoomRecordOrder {
    std::string sender;
    std::string site;
    std::uint32_t number = 0;  // chosen by the sender; RoomRecording repeats it
    RecordOrderKind kind = RecordOrderKind::kStart;
    std::string folder;  // kStart: name of the new folder in the site's folder of recordings
};

enum class RoomRecordingState : std::uint8_t { kNone, kRunning, kComplete, kEnded };

/// The newest recording of a site that takes orders. Once a second and after each order.
struct RoomRecording {
    std::string site;
    Timestamp time;
    RoomRecordingState state = RoomRecordingState::kNone;  // kEnded: by a fault
    std::string sender;                                    // of the last order; empty: none
    std::uint32_t number = 0;                              // of that order
    bool is_refused = false;                               // that order
    std::string text;      // the folder, or the reason; at most 255 printable ASCII characters
    double seconds = 0.0;  // since its begin; of a complete one its length
    std::uint64_t num_pictures = 0;  // written, of all cameras
    std::uint64_t num_dropped = 0;   // that came and are not in the recording
    std::uint64_t num_bytes = 0;
};

enum class ProgramKind : std::uint8_t {
    kSiteNode,
    kWorldServer,
    kViewer,
    kOther,
    kCameraNode,
    kRegionNode
};

/// The keys that are no longer valid, as a member knows them. Transient local, when the list
/// changes, and every four seconds as a sign of life (peer_leases.hpp).
struct RevokedKeys {
    std::string sender;             // name of the member
    std::vector<std::uint8_t> crl;  // PEM text, signed by the identity authority
};

/// A process present in the world. Transient local, at its start and every ten seconds.
struct Presence {
    ProgramKind kind = ProgramKind::kOther;
    std::string name;            // of the site, world or viewer; of a camera node SITE.HOST
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
