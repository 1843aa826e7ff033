#pragma once

#include "core/base/timestamp.hpp"
#include "core/bus/status_messages.hpp"

#include <Eigen/Core>

#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

/// Defines the messages between the camera nodes of a site and its model part. Include
/// messages.hpp, which has the others too.
namespace atrium::bus {

/// What a camera node found in one picture. Every picture, latest only.
struct CameraSilhouette {
    std::string site;
    std::uint32_t camera = 0;
    std::string host;               // of the camera node
    std::uint64_t frame_id = 0;     // of the CameraTexture of this picture, with `capture_time`
    Timestamp capture_time;         // on the clock of that host
    std::uint64_t clock_epoch = 0;  // changes when that clock is set
    std::uint64_t rig = 0;          // fingerprint of its rig and part
    bool has_picture = false;       // false: the picture of this time is lost
    bool has_texture = false;       // a CameraTexture of this picture follows
    bool is_view_shifted = false;   // the picture shows the learned room shifted
    std::array<double, 2> view_shift_px{};
    std::uint32_t num_contours_dropped = 0;
    double segmentation_ms = 0.0;
    double polygons_ms = 0.0;
    double texture_ms = 0.0;         // of the camera's previous texture
    std::uint32_t colour_bytes = 0;  // of the camera's previous texture
    std::uint32_t mask_bytes = 0;
    std::vector<std::uint32_t> contour_sizes;        // vertices of each contour
    std::vector<std::array<double, 2>> vertices_px;  // of all contours in turn, undistorted
};

/// The model part's wishes and its question for the clocks of the hosts. 10 Hz.
struct SiteOrders {
    std::string site;
    std::uint64_t number = 0;
    Timestamp asked;  // on the clock of the model part's host
    std::uint32_t jpeg_quality = 85;
    std::uint32_t colour_divisor = 1;
    /// Textures of one of `send_every` instants are wanted; `sent` is one of these instants, on the
    /// clock of the model part's host.
    std::uint32_t send_every = 1;
    Timestamp sent;
    std::chrono::nanoseconds period{1};  // between two instants
};

/// Whether `orders` want the texture of a picture of this time. The clock of the picture's host may
/// be off by less than half a period.
bool is_texture_wanted(const SiteOrders& orders, Timestamp capture_time);

/// The answer to each SiteOrders. Four times, as in NTP, tell how far the clock is off.
struct ClockAnswer {
    std::string site;
    std::string host;
    std::uint64_t number = 0;  // of the question
    Timestamp asked;           // as in the question
    Timestamp received;        // on the clock of the answering host
    Timestamp answered;
    std::uint64_t clock_epoch = 0;
};

/// The silhouettes of one instant, for a host that computes the hulls of regions. Every metaframe,
/// latest only.
struct RegionOrder {
    std::string site;
    std::string host;          // that computes
    std::uint64_t number = 0;  // of the order to this host
    std::uint64_t frame_id = 0;
    Timestamp capture_time;              // a new model part counts frames anew, but not times
    std::uint64_t settings = 0;          // fingerprint of the rig and of all that hulls depend on
    std::vector<std::uint32_t> cameras;  // that have a picture
    std::vector<std::uint32_t> contour_counts;       // of each of these cameras
    std::vector<std::uint32_t> contour_sizes;        // vertices of each contour
    std::vector<std::array<double, 2>> vertices_px;  // of all contours in turn, undistorted
};

/// `kOtherRig`: not computed, because the order is of another rig or [hull].
enum class RegionOutcome : std::uint8_t { kNobody, kMesh, kFailed, kOtherRig };

struct RegionHull {
    std::uint32_t region = 0;  // index into the regions of the site's file
    RegionOutcome outcome = RegionOutcome::kNobody;
    std::uint32_t num_bytes = 0;  // of its mesh

    bool operator==(const RegionHull&) const = default;
};

/// The answer to a RegionOrder: the meshes of the regions of one host.
struct RegionMeshes {
    std::string site;
    std::string host;
    std::uint64_t frame_id = 0;  // as in the order
    Timestamp capture_time;      // as in the order
    double hull_ms = 0.0;
    double mesh_ms = 0.0;  // to code the meshes
    LeftOutTotals left_out;
    std::string reason;  // printable: why a region failed; empty: none did
    std::vector<RegionHull> regions;
    std::vector<std::uint8_t> draco;  // their meshes in turn
};

/// The state of a program that computes the hulls of regions. 1 Hz. Counters start with the
/// program.
struct RegionNodeStatus {
    std::string site;
    std::string host;
    Timestamp time;
    std::uint32_t num_regions = 0;
    std::uint64_t num_orders = 0;        // taken
    std::uint64_t num_meshes = 0;        // published, of all orders
    std::uint64_t num_dropped_late = 0;  // orders replaced by a newer one before their turn
    std::uint64_t num_failed = 0;  // orders of which a region failed, or that were not answered
    std::uint64_t num_bytes_published = 0;
    double orders_per_s = 0.0;
    double bytes_per_s = 0.0;
    LatencySummary order_to_mesh;  // from the taken order to the written meshes
    std::uint64_t resident_bytes = 0;
    StageTimes stages;  // hull, coding and publishing
    ProcessorUse processor;
    double first_output_s = 0.0;  // from process start to the first meshes; 0: none yet
};

/// The state of a camera node. 1 Hz. Counters start with the program.
struct CameraNodeStatus {
    std::string site;
    std::string host;
    Timestamp time;
    std::uint64_t num_pictures = 0;      // captured
    std::uint64_t num_silhouettes = 0;   // published
    std::uint64_t num_textures = 0;      // published
    std::uint64_t num_dropped_late = 0;  // pictures replaced by a newer one before their turn
    std::uint64_t num_failed = 0;
    std::uint64_t num_bytes_published = 0;
    double silhouettes_per_s = 0.0;  // of all cameras
    double silhouette_bytes_per_s = 0.0;
    double texture_bytes_per_s = 0.0;
    LatencySummary capture_to_silhouette;
    std::uint64_t resident_bytes = 0;
    std::vector<std::uint32_t> camera_indices;  // into SiteDescription::cameras
    std::vector<CameraStatus> cameras;          // of each of them
    ProcessorUse processor;
    double first_output_s = 0.0;         // from process start to the first silhouette; 0: none yet
    bool is_clock_synchronised = false;  // according to the host's kernel (adjtimex)
    std::chrono::nanoseconds clock_max_error{0};
};

}  // namespace atrium::bus
