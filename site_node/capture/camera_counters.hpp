#pragma once

#include "core/config/rig.hpp"

#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace atrium::capture {

/// What became of the pictures of one camera since the start.
struct CameraCounters {
    std::string name;                  // of the camera, as in the rig
    bool connected = false;            // now
    std::uint64_t num_received = 0;    // whole pictures
    std::uint64_t num_incomplete = 0;  // that lack packets, are not as agreed, or cannot be read
    std::uint64_t num_resent = 0;      // packets that the camera sent again
    std::uint64_t num_late = 0;        // whole, but replaced by a newer one before it was taken
    std::uint64_t num_dropped = 0;     // lost because all buffers were in use
    std::uint64_t num_backwards = 0;   // whole, but older than the one before
    std::uint64_t num_reconnects = 0;
    std::optional<std::chrono::steady_clock::time_point> last_picture;  // when a whole one came

    bool operator==(const CameraCounters&) const = default;
};

/// Counted since `former`, of the same camera; `connected` and `last_picture` are as in `now`.
CameraCounters since(const CameraCounters& former, const CameraCounters& now);

/// `key=value ...` for the log.
std::string to_line(const CameraCounters& counters);

/// True where something besides received pictures was counted.
bool has_faults(const CameraCounters& counters);

/// Counts for a source without cameras: they are always connected. Thread-safe.
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
