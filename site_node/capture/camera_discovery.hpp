#pragma once

#include "core/base/expected.hpp"

#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace atrium::capture {

/// Identity of a camera that answered.
struct FoundCamera {
    std::string vendor;
    std::string model;
    std::string serial;
    std::string address;   // IPv4; for USB cameras the device id by which Aravis opens them
    std::string protocol;  // "GigEVision" or "USB3Vision"
};

/// Returns all cameras in the networks and at the USB ports of this machine, sorted by address.
/// Takes about a second. Thread-safe; concurrent calls run one after the other.
std::vector<FoundCamera> discover_cameras();

/// Queries the identity of the GigE Vision camera at `address`, for at most `timeout`. Empty: no
/// answer.
std::optional<FoundCamera> ask_gige_camera(const std::string& address,
                                           std::chrono::milliseconds timeout);

/// Formats a table with a header line and one line per camera.
std::string camera_table(const std::vector<FoundCamera>& cameras);

/// Finds cameras for several threads, which share one discovery.
class CameraFinder {
public:
    /// Finds the camera with this serial number, at this address, or both; empty means any. Error
    /// kNotFound. A known address is queried directly, and a missing camera does not delay the
    /// others.
    Expected<FoundCamera> find(const std::string& serial, const std::string& address);

private:
    std::optional<FoundCamera> known(const std::string& serial);
    std::mutex mutex_;  // held during a discovery: the next caller uses its result
    std::vector<FoundCamera> found_;
    std::optional<std::chrono::steady_clock::time_point> last_discovery_;
};

}  // namespace atrium::capture
