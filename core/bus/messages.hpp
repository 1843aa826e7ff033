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

/// What travels between the programs, as C++ values: one struct per topic (idl/README.md has the
/// table). Everything that a Reader hands out has passed the checks of `from_wire`: finite numbers,
/// known sizes, indices and enumerators in range.
namespace atrium::bus {

/// Transient local, on change. Names are 1..63 characters of [A-Za-z0-9_.-].
struct SiteDescription {
    std::string site;
    std::vector<geometry::CalibratedCamera> cameras;  // CameraTexture::camera indexes this
    geometry::Aabb bounds_site;                       // [m] the space in which people are seen
};

/// Every frame, latest only.
struct SiteMesh {
    std::string site;
    std::uint64_t frame_id = 0;  // grows by one per metaframe of the site, dropped ones included
    Timestamp capture_time;
    std::vector<std::uint32_t>
        textured_cameras;  // a viewer's pair is complete with these CameraTextures of this frame_id
    std::vector<std::uint8_t> draco;  // empty: nobody is in the site
};

/// Every frame and camera that sees somebody, latest only.
struct CameraTexture {
    std::string site;
    std::uint32_t camera = 0;
    std::uint64_t frame_id = 0;
    Timestamp capture_time;
    image::PixelRect
        crop_px;  // in the camera's full-resolution distorted picture; coded at half resolution
    std::vector<std::uint8_t> colour;
    std::vector<std::uint8_t> mask;
};

/// Transient local, on change; decided by the world server.
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

/// Transient local, on change.
struct SceneObject {
    std::uint32_t object = 0;
    std::string name;
    Shape shape = Shape::kBox;
    /// [m] box: full extents; sphere: diameter thrice; cylinder, capsule: diameter, diameter,
    /// height along local z (a capsule's height includes its caps); plane: full extents x, y of
    /// what is drawn, through the origin, normal +z, third unused; convex, compound: full extents
    /// of the model as scaled; soft: full extents of its nodes at the start.
    Eigen::Vector3d size_m = Eigen::Vector3d::Ones();
    double mass_kg = 0.0;  // 0: does not move
    double friction = 0.6;
    double restitution = 0.2;
    Eigen::Vector3d colour = Eigen::Vector3d::Constant(0.7);  // linear RGB in [0, 1]
    /// Convex, compound: what it looks like, in the object's frame; a file of the folder of models
    /// that every host has of its own (checks.hpp, is_valid_model_file). Empty: none.
    std::string model;
    double model_scale = 1.0;                    // [m] per unit of the model
    std::string texture;                         // a picture of that folder; empty: none
    geometry::RigidTransform world_from_object;  // where it started; SceneState tells where it is
};

/// Transient local, on change: which nodes of a soft object are joined to what is drawn.
struct SoftBody {
    std::uint32_t object = 0;
    std::uint32_t num_nodes = 0;
    double thickness_m = 0.0;                             // diameter of what segments are drawn as
    std::vector<std::array<std::uint16_t, 3>> triangles;  // nodes; seen from both sides
    std::vector<std::array<std::uint16_t, 2>> segments;
};

/// Every step sent, latest only: where the nodes of a soft object are (soft_nodes.hpp).
struct SoftBodyState {
    std::uint32_t object = 0;
    std::uint64_t tick = 0;  // as in the SceneState of the same moment, and so is the time
    Timestamp time;
    Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();  // world
    double step_m = 1e-4;
    std::vector<std::array<std::uint16_t, 3>> nodes;  // p_world = origin_m + step_m * node
};

/// Transient local, on change: a model that is only looked at, and that each viewer loads itself.
struct Scenery {
    std::string name;
    std::string model;  // as SceneObject's, and so are the next three
    double model_scale = 1.0;
    std::string texture;
    Eigen::Vector3d colour = Eigen::Vector3d::Constant(0.7);  // where the model has none
    geometry::RigidTransform world_from_model;
};

/// A sample of a person's surface as the physics has it; proxy_points.hpp makes and reads these.
struct ProxyPoint {
    std::array<std::uint16_t, 3> place{};         // p_world = origin_m + step_m * place
    std::array<std::int16_t, 3> velocity_mmps{};  // [mm/s] world
    std::array<std::int16_t, 3> normal{};         // outwards, 32767 times the unit vector

    bool operator==(const ProxyPoint&) const = default;
};

/// Where a person touches a rigid object.
struct Touch {
    std::uint32_t object = 0;
    Eigen::Vector3d point_world = Eigen::Vector3d::Zero();  // [m] on the person
};

/// At most ten a second, latest only, and only while somebody reads it: what the physics takes the
/// person of a site for.
struct PersonProxy {
    std::string site;
    Timestamp capture_time;         // of the mesh that it is moving to, or has come to
    std::uint32_t num_surfels = 0;  // that the physics has; `points` are an even choice of them
    Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();  // world
    double step_m = 1e-4;
    std::vector<ProxyPoint> points;
    std::vector<Touch> touches;  // in the same tick
};

/// Transient local, on change: what the physics takes an object with a model for, the edges of its
/// convex parts.
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

/// Every step sent, latest only.
struct SceneState {
    std::string world;
    std::uint64_t tick = 0;
    Timestamp time;  // when the tick was due
    std::vector<ObjectState> objects;
};

/// 5 Hz, from each viewer to each site that it sees: how the site's stream arrives. Counts and
/// rates are since the sample before.
struct StreamFeedback {
    std::string viewer;
    std::string site;
    Timestamp time;
    std::uint64_t newest_frame_id = 0;  // of a complete mesh and textures; 0 where there was none
    std::uint32_t num_complete = 0;     // frames
    std::uint32_t num_incomplete = 0;   // frames with parts missing when a newer one was complete
    std::uint32_t num_late = 0;         // samples of frames no newer than one that was complete
    std::uint32_t num_samples = 0;      // meshes and textures that came
    double payload_bytes_per_s = 0.0;   // of those
    /// Clocks of two hosts need not agree: a delay may be negative, and only its change means
    /// something.
    double min_delay_ms = 0.0;   // from writing to taking, of any of those; 0 where there are none
    double sure_delay_ms = 0.0;  // of that, what certainly was no wait in the viewer's host
    double median_delay_ms = 0.0;  // from capture until a frame was complete; where none was, the
                                   // smallest of any sample
    /// Longest time that a sample may have waited in the viewer's host.
    double longest_wait_ms = 0.0;
};

enum class CommandKind : std::uint8_t {
    kAdd,
    kRemove,
    kReset,
    kPush,
    kGrab,     // take hold of an object at one point; again: at another point
    kMove,     // pull it elsewhere; also says that the sender still holds it
    kRelease,  // let go
    kSave,     // the state of the whole world, to the server's file
    kRestore   // from there
};

/// On demand, reliable. `object` is filled for kAdd; `target` names the object for kRemove, kPush,
/// kGrab, kMove and kRelease.
struct SceneCommand {
    std::string sender;
    CommandKind kind = CommandKind::kReset;
    std::uint32_t target = 0;
    Eigen::Vector3d impulse_ns =
        Eigen::Vector3d::Zero();  // [N s] world, at the centre of mass, for kPush
    /// [m] the point that is held, for kGrab: in the object's frame, of a soft one in the world.
    Eigen::Vector3d point_object = Eigen::Vector3d::Zero();
    /// [m] where that point is pulled to, for kGrab and kMove.
    Eigen::Vector3d goal_world = Eigen::Vector3d::Zero();
    SceneObject object;
};

struct LatencySummary {
    double median_ms = 0.0;
    double p99_ms = 0.0;
    std::uint64_t num_samples = 0;
};

/// What hulls lack, or had mended in them, over all metaframes that have one.
struct LeftOutTotals {
    std::uint64_t num_cameras = 0;            // that delivered nothing
    std::uint64_t num_phantoms = 0;           // components that no silhouette needs
    std::uint64_t num_fragments = 0;          // components that are too small
    double dropped_l = 0.0;                   // volume of both [l], up to kMaxStatistic
    std::uint64_t num_contours_dropped = 0;   // too small, or beyond repair
    std::uint64_t num_contours_repaired = 0;  // crossings that were taken apart
    std::uint64_t num_regions_failed = 0;     // beside others that did not

    bool operator==(const LeftOutTotals&) const = default;
};

/// What became of the pictures of one camera.
struct CameraStatus {
    std::string name;
    bool connected = false;
    std::uint64_t num_received = 0;    // whole pictures
    std::uint64_t num_incomplete = 0;  // that lack packets, or could not be read
    std::uint64_t num_resent = 0;      // packets
    std::uint64_t num_late = 0;        // replaced by a newer one before they were taken
    std::uint64_t num_dropped = 0;     // all buffers were in use
    std::uint64_t num_backwards = 0;   // older than the one before
    std::uint64_t num_reconnects = 0;
    double offset_ms = 0.0;             // learned: how much later than the others' its times are
    double last_picture_age_ms = -1.0;  // since the last whole picture came; -1: none came yet

    bool operator==(const CameraStatus&) const = default;
};

/// How a site adapts its stream to the networks of its viewers.
struct StreamState {
    std::uint32_t jpeg_quality = 85;
    std::uint32_t colour_divisor = 1;  // 1: colours as large as the mask; 2: half as wide and high
    std::uint32_t send_every = 1;      // of n metaframes one is sent
    double cap_bit_per_s = 0.0;        // 0: none
    std::string cap_set_by;            // a viewer, or the option that is the limit; empty: nobody
    std::uint64_t num_dropped_for_rate = 0;  // metaframes, so as to stay below the cap

    bool operator==(const StreamState&) const = default;
};

/// Medians of a site's stages over its last metaframes [ms]; 0 where there was none yet.
struct StageTimes {
    double silhouettes_ms = 0.0;  // segmentation and polygons of all cameras
    double hull_ms = 0.0;
    double coding_ms = 0.0;      // mesh and textures
    double publishing_ms = 0.0;  // handing all samples of a metaframe to the network

    bool operator==(const StageTimes&) const = default;
};

/// 1 Hz. Counters run since the program's start.
struct SiteStatus {
    std::string site;
    Timestamp time;
    std::uint64_t num_metaframes_captured = 0;
    std::uint64_t num_metaframes_published = 0;
    std::uint64_t num_incomplete_used = 0;     // went on without some cameras
    std::uint64_t num_dropped_incomplete = 0;  // a camera's picture was missing at the deadline
    std::uint64_t num_dropped_late = 0;  // a newer metaframe replaced it before it was worked on
    std::uint64_t num_failed = 0;        // a stage reported an error for it
    LeftOutTotals left_out;
    std::uint64_t num_bytes_published = 0;
    double metaframes_per_s = 0.0;
    double bytes_per_s = 0.0;
    LatencySummary capture_to_publish;
    std::uint64_t resident_bytes = 0;
    std::vector<CameraStatus> cameras;  // as in SiteDescription
    StreamState stream;
    StageTimes stages;
    double mesh_bytes_per_s = 0.0;  // of bytes_per_s, like the next one
    double texture_bytes_per_s = 0.0;
    ProcessorUse processor;
    double first_output_s = 0.0;  // from the process's start to its first metaframe; 0: none yet
};

struct WorldStatus {
    std::string world;
    Timestamp time;
    std::uint64_t num_steps = 0;
    std::uint64_t num_meshes_received = 0;
    std::uint64_t num_rejected = 0;  // samples that failed a check
    std::uint64_t num_sites = 0;     // present now
    std::uint64_t num_contacts =
        0;  // between people and objects, running count of steps with at least one
    double steps_per_s = 0.0;
    LatencySummary capture_to_collision;  // capture_time to the step that first used the mesh
    std::uint64_t resident_bytes = 0;
    std::uint64_t num_objects = 0;  // now, soft ones included
    std::uint64_t num_resets = 0;   // of one object, by a guard: not a number, or out of the world
    std::uint32_t last_reset = 0;   // the object of the latest of those; 0: there was none
    std::uint64_t num_skipped_ticks = 0;
    std::uint64_t num_refused = 0;  // commands, of num_rejected
    std::uint64_t num_grabs = 0;    // now
    std::uint64_t num_saves = 0;    // of the state
    std::uint64_t num_bytes_published = 0;
    double bytes_per_s = 0.0;
    LatencySummary step;     // computing one tick
    LatencySummary prepare;  // from taking a mesh from the bus until the step can use it
    std::uint64_t num_meshes_dropped = 0;  // replaced by a newer one before they were prepared
    std::uint64_t state_tick = 0;          // the state's hash after this tick; 0: not hashed yet
    std::uint64_t state_hash = 0;
    ProcessorUse processor;
    double first_output_s = 0.0;  // from the process's start to its first state; 0: none yet
};

struct ViewerStatus {
    std::string viewer;
    Timestamp time;
    std::uint64_t num_frames = 0;       // pictures drawn
    std::uint64_t num_pairs_shown = 0;  // complete mesh + texture pairs that reached the screen
    std::uint64_t num_pairs_skipped =
        0;                             // complete, replaced by a newer one before they were drawn
    std::uint64_t num_incomplete = 0;  // a newer frame was complete first
    std::uint64_t num_rejected = 0;    // samples that failed a check
    double frames_per_s = 0.0;
    LatencySummary capture_to_display;
    std::uint64_t resident_bytes = 0;
    ProcessorUse processor;
    double first_output_s = 0.0;    // from the process's start to its first picture; 0: none yet
    double max_frames_per_s = 0.0;  // that it allows itself now [Hz]; 0: it does not draw yet
    double scale = 0.0;             // of the picture's sides, in [0, 1]; 0: likewise
    bool has_shadows = false;       // whether it draws them now
    std::uint64_t num_video_dropped = 0;  // pictures for which a video repeats the one before
};

enum class ProgramKind : std::uint8_t { kSiteNode, kWorldServer, kViewer, kOther };

/// Transient local, at the start and every ten seconds: one per process that is there.
struct Presence {
    ProgramKind kind = ProgramKind::kOther;
    std::string name;            // of the site, world, viewer
    std::uint64_t instance = 0;  // no two processes have the same
    bool is_holder = false;      // the name is its; false: it still asks for it
    std::uint64_t num_written = 0;
    std::string host;
    std::uint32_t pid = 0;
    std::string version;
    Timestamp start_time;
    bool is_clock_synchronised = false;  // as the kernel of its host says
    std::chrono::nanoseconds clock_max_error{0};
};

}  // namespace atrium::bus
