#pragma once

#include "core/base/processor_use.hpp"
#include "core/base/timestamp.hpp"

#include <cstdint>
#include <string>
#include <vector>

/// Defines the status messages of all programs. Include messages.hpp, which has the others too.
namespace atrium::bus {

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

/// How far one camera of a rig agrees with the others.
struct CameraCoherence {
    std::string name;
    double rms_px = 0.0;  // of its tangencies, robust
    double share = 1.0;   // of its tangencies that fit, in [0, 1]
    std::uint32_t num_tangencies = 0;

    bool operator==(const CameraCoherence&) const = default;
};

/// What is wrong with one camera, and its cure.
struct RigFault {
    std::uint32_t camera = 0;    // index into RigCoherence::cameras
    double turned_deg = -1.0;    // since the calibration; -1: not certain
    double moved_mm = -1.0;      // since the calibration; -1: not certain
    bool is_either = false;      // the turn or the motion alone explains all
    double late_instants = 0.0;  // its pictures show what was so many instants before
    double effect_px = 0.0;      // in its pictures
    std::string cure;            // printable: the command that mends the rig, or what to check

    bool operator==(const RigFault&) const = default;
};

enum class RigVerdict : std::uint8_t { kUnknown, kCoherent, kMoved, kLate, kIncoherent, kLenses };

/// Whether silhouettes show that a site's cameras are where its rig says.
struct RigCoherence {
    RigVerdict verdict = RigVerdict::kUnknown;
    double rms_px = 0.0;                   // of all tangencies, robust
    std::uint32_t num_instants = 0;        // that were judged
    std::vector<CameraCoherence> cameras;  // in the order of SiteDescription; empty: not judged yet
    RigFault fault;  // if `has_fault`; else of kIncoherent and kLenses, `cure`

    bool has_fault() const { return verdict == RigVerdict::kMoved || verdict == RigVerdict::kLate; }
    bool operator==(const RigCoherence&) const = default;
};

enum class HostState : std::uint8_t {
    kMissing,
    kInUse,
    kClockUnknown,
    kClockWrong,
    kLate,
    kOtherRig
};

/// One host of a site on several: its cameras, or the regions whose hulls it computes.
struct HostStatus {
    std::string name;
    HostState state = HostState::kMissing;
    /// Its clock minus that of the model part's host. Without a meaning if kMissing or
    /// kClockUnknown.
    double clock_offset_ms = 0.0;
    double clock_error_ms = 0.0;  // how far off that figure may be
    std::uint32_t num_cameras = 0;
    /// 0: it has cameras. The clock, kClockUnknown and kClockWrong concern cameras only.
    std::uint32_t num_regions = 0;
    std::uint64_t num_left_out = 0;  // pictures or orders not used because of the host's state

    bool operator==(const HostStatus&) const = default;
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
    RigCoherence coherence;
    std::string finding;  // printable: what silhouettes show to be wrong, with its cure; or empty
    std::vector<HostStatus> hosts;  // with cameras or regions; empty: one process does all
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

}  // namespace atrium::bus
