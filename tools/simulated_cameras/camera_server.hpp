#pragma once

#include "tools/simulated_cameras/faults.hpp"
#include "tools/simulated_cameras/shown_pictures.hpp"

#include <memory>
#include <string>
#include <vector>

namespace atrium::simulated_cameras {

/// Network identity of a camera.
struct CameraIdentity {
    std::string name;
    std::string serial;   // its name, if short enough for a serial number
    std::string address;  // 127.0.0.2 for the first
};
std::vector<CameraIdentity> identities_of(const config::Rig& rig);

struct ServerOptions {
    std::chrono::microseconds empty_time{};
    bool stamp = false;      // mark pictures with camera and trigger (stamp.hpp)
    std::uint64_t seed = 1;  // of lost packets
    Faults faults;           // of every camera of the rig
};

/// Serves one GigE Vision camera per camera of the rig. Each is a thread of Aravis' fake camera
/// with its own address. They run freely at the rig's rate, triggered at the same instants, or by
/// software triggers, and all show the same scene. A client may change the frame rate and the
/// region, but not the pixel format.
class CameraServer {
public:
    /// The addresses must exist (`app::bring_up_loopback`). Error kUnavailable names the camera
    /// that cannot listen.
    static Expected<std::unique_ptr<CameraServer>> start(ShownPictures shown,
                                                         const ServerOptions& options);
    ~CameraServer();

    /// Executes the outages of `ServerOptions::faults` until the stop.
    void follow_outages(std::stop_token stop);

    /// Empties the room for `ServerOptions::empty_time`.
    void empty_room();

    /// Number of pictures sent, per camera.
    std::vector<std::uint64_t> num_sent() const;

    const std::vector<CameraIdentity>& identities() const;

private:
    struct Impl;
    explicit CameraServer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::simulated_cameras
