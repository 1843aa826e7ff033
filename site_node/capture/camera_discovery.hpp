#pragma once

#include "core/base/expected.hpp"

#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace atrium::capture {

/// A camera that answered.
struct FoundCamera {
    std::string vendor;
    std::string model;
    std::string serial;
    std::string address;   // IPv4; of USB cameras the identity that Aravis opens them by
    std::string protocol;  // "GigEVision" or "USB3Vision"
};

/// All cameras in the networks and at the USB ports of this machine, by address. Takes about a
/// second. Thread-safe, one at a time.
std::vector<FoundCamera> discover_cameras();

/// Asks the GigE Vision camera at `address` who it is, and gives it `timeout`. Nothing: there is
/// none, or it does not answer.
std::optional<FoundCamera> ask_gige_camera(const std::string& address,
                                           std::chrono::milliseconds timeout);

/// A table for people to read, one line per camera and one for the heads of the columns.
std::string camera_table(const std::vector<FoundCamera>& cameras);

/// Finds the cameras that several threads look for, with one discovery for all of them.
class CameraFinder {
public:
    /// The camera with this serial number, at this address, or both; empty means any. Error
    /// kNotFound. A camera whose address is known is asked directly, so that a missing one costs
    /// others nothing.
    Expected<FoundCamera> find(const std::string& serial, const std::string& address);

private:
    std::optional<FoundCamera> known(const std::string& serial);
    std::mutex mutex_;  // held while discovering: who comes second uses the result
    std::vector<FoundCamera> found_;
    std::optional<std::chrono::steady_clock::time_point> last_discovery_;
};

}  // namespace atrium::capture
