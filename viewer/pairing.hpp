#pragma once

#include "core/base/timestamp.hpp"
#include "core/bus/messages.hpp"

#include <chrono>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace atrium::viewer {

/// A mesh and the pictures that belong to it, all of one metaframe.
struct FramePair {
    bus::SiteMesh mesh;
    std::vector<bus::CameraTexture> textures;  // one per camera in `mesh.textured_cameras`
};

struct PairingOptions {
    /// Per site; the oldest gives way. More than the history of a stream (qos/profiles.xml): what
    /// waited for a repair comes together, first all meshes, then all pictures of a camera.
    std::size_t max_pending_frames = 10;
    std::size_t max_sites = 64;  // further sites are ignored
    /// A sample this much older than the pair handed out last is not late: the site's clock was set
    /// back, and the site begins anew.
    std::chrono::nanoseconds max_disorder = std::chrono::seconds(2);
};

/// Puts meshes and textures of the same metaframe together, whatever order they come in.
///
/// A pair is handed out once it is complete. Per site, the pairs handed out have rising capture
/// times: what is older than the last one is dropped. A frame is identified by capture time and
/// frame id together, so that a site that starts again, and counts its frames from 0 again, is
/// neither mixed with what it was before nor taken for old. Not thread-safe.
class Pairing {
public:
    explicit Pairing(const PairingOptions& options = {}) : options_(options) {}

    std::optional<FramePair> add(bus::SiteMesh mesh);
    std::optional<FramePair> add(bus::CameraTexture texture);

    /// The site is gone: whatever comes from it next is new.
    void forget(const std::string& site);

    /// Frames of which a part was still missing when a newer one was complete, or that gave way.
    std::uint64_t num_incomplete() const { return num_incomplete_; }
    /// Samples of frames not newer than the last one handed out.
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
    struct Site {
        std::optional<FrameKey> last;  // handed out
        std::map<FrameKey, PendingFrame> pending;
    };

    PendingFrame* find_or_add(const std::string& site, const FrameKey& key);
    std::optional<FramePair> hand_out_if_complete(const std::string& site, const FrameKey& key);

    PairingOptions options_;
    std::map<std::string, Site> sites_;
    std::uint64_t num_incomplete_ = 0;
    std::uint64_t num_late_ = 0;
};

}  // namespace atrium::viewer
