#pragma once

#include "core/config/rig.hpp"

#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace atrium::capture {

/// Counts the pictures of one camera since the start.
struct CameraCounters {
    std::string name;                  // as in the rig
    bool connected = false;            // at this moment
    std::uint64_t num_received = 0;    // whole pictures
    std::uint64_t num_incomplete = 0;  // lacking packets, in the wrong format, or unreadable
    std::uint64_t num_resent = 0;      // packets that the camera sent again
    std::uint64_t num_late = 0;        // whole, but replaced by a newer one before use
    std::uint64_t num_dropped = 0;     // lost because all buffers were in use
    std::uint64_t num_backwards = 0;   // whole, but older than the previous one
    std::uint64_t num_reconnects = 0;
    std::optional<std::chrono::steady_clock::time_point> last_picture;  // arrival of a whole one

    bool operator==(const CameraCounters&) const = default;
};

/// Returns the counts since `former` of the same camera; `connected` and `last_picture` are those
/// of `now`. All of `now` if the counting began anew.
CameraCounters since(const CameraCounters& former, const CameraCounters& now);

/// Returns the counts of both, of the same camera; `connected` and the name are those of `now`.
CameraCounters sum(const CameraCounters& former, const CameraCounters& now);

/// Formats the counts as `key=value ...` for the log.
std::string to_line(const CameraCounters& counters);

/// Returns true if anything except received pictures was counted.
bool has_faults(const CameraCounters& counters);

/// Counts for a source without cameras, which is always connected. Thread-safe.
class DeliveryCounters {
public:
    explicit DeliveryCounters(const config::Rig& rig);

    void count_received(std::size_t camera);
    void count_incomplete(std::size_t camera);
    std::vector<CameraCounters> counters() const;

private:
    mutable std::mutex mutex_;
    std::vector<CameraCounters> cameras_;
};

}  // namespace atrium::capture
