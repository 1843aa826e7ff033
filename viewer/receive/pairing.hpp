#pragma once

#include "core/base/timestamp.hpp"
#include "core/bus/messages.hpp"

#include <chrono>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace atrium::viewer {

/// A mesh with its textures, all of one metaframe.
struct FramePair {
    bus::SiteMesh mesh;
    std::vector<bus::CameraTexture> textures;  // one per camera in `mesh.textured_cameras`
    Timestamp delays_from{};                   // see bus::delays_from
};

struct PairingOptions {
    /// Per site; the oldest is dropped. More than the history of a stream (qos/profiles.xml):
    /// samples that waited for a retransmission arrive in a burst, first all meshes, then all
    /// textures of one camera.
    std::size_t max_pending_frames = 10;
    std::size_t max_sites = 64;  // further sites are ignored
    /// Textures of a camera node that wait for the mesh that names them: half a second at 60 Hz.
    std::size_t max_waiting_textures = 30;
    /// A sample this much older than the last pair means that the site's clock was set back. The
    /// site then starts over.
    std::chrono::nanoseconds max_disorder = std::chrono::seconds(2);
};

/// Matches meshes and textures of the same metaframe in any order of arrival.
///
/// Returns each pair once it is complete. The pairs of one site have rising capture times: samples
/// older than the last pair are dropped. Capture time and frame id together identify a frame, so a
/// restarted site, which counts its frames from 0 again, is neither mixed with its former frames
/// nor taken for late. A site on several hosts is different: each camera node numbers its own
/// pictures, and the mesh names the texture of each camera (`bus::SiteMesh::texture_frames`). Not
/// thread-safe.
class Pairing {
public:
    explicit Pairing(const PairingOptions& options = {}) : options_(options) {}

    std::optional<FramePair> add(bus::SiteMesh mesh);
    std::optional<FramePair> add(bus::CameraTexture texture);

    /// Forgets what is pending of a site that is gone. When it is back, DDS may deliver its last
    /// samples once more: they still are late.
    void forget(const std::string& site);
    /// Forgets all of a site that ended its stream itself: it may begin again at any time, such as
    /// a recording that jumps back.
    void start_over(const std::string& site) { sites_.erase(site); }

    /// Frames dropped incomplete, because a newer one was complete or because too many were
    /// pending.
    std::uint64_t num_incomplete() const { return num_incomplete_; }
    /// Samples of frames not newer than the last pair.
    std::uint64_t num_late() const { return num_late_; }
    std::size_t num_pending(const std::string& site) const;

private:
    struct FrameKey {
        Timestamp capture_time;
        std::uint64_t frame_id = 0;
        auto operator<=>(const FrameKey&) const = default;
    };
    struct PendingFrame {
        std::optional<bus::SiteMesh> mesh;
        std::map<std::uint32_t, bus::CameraTexture> textures;
    };
    /// Textures of one camera that have keys of their own.
    struct OwnTextures {
        std::optional<FrameKey> last;  // in a pair
        std::map<FrameKey, bus::CameraTexture> waiting;
        std::deque<FrameKey> arrivals;  // of `waiting`, and of some that left it
    };
    struct Site {
        std::optional<FrameKey> last;  // last pair returned
        std::map<FrameKey, PendingFrame> pending;
        bool is_gone = false;  // makes room for another site
        /// The meshes name their textures: these wait here, not in `pending`.
        bool names_textures = false;
        std::map<std::uint32_t, OwnTextures> own_textures;  // per camera
    };

    PendingFrame* find_or_add(const std::string& site, const FrameKey& key);
    void note_naming(Site& site, const bus::SiteMesh& mesh);
    bool keep_waiting(Site& site, bus::CameraTexture texture);
    static FrameKey texture_key(const bus::SiteMesh& mesh, std::size_t index);
    static bool collect(Site& site, PendingFrame& frame);
    std::optional<FramePair> hand_out_newest(const std::string& site);
    std::optional<FramePair> hand_out_if_complete(const std::string& site, const FrameKey& key);

    PairingOptions options_;
    std::map<std::string, Site> sites_;
    std::uint64_t num_incomplete_ = 0;
    std::uint64_t num_late_ = 0;
};

}  // namespace atrium::viewer
