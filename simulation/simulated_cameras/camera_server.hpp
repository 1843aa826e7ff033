#pragma once

#include "simulation/simulated_cameras/faults.hpp"
#include "simulation/simulated_cameras/show.hpp"

#include <memory>
#include <string>
#include <vector>

namespace atrium::simulated_cameras {

/// How a camera of the rig is found on the network.
struct CameraPlace {
    std::string name;
    std::string serial;   // its name, where a serial number can be as long
    std::string address;  // 127.0.0.2 for the first
};
std::vector<CameraPlace> places_of(const config::Rig& rig);

struct ServerOptions {
    std::chrono::microseconds empty_time{};
    bool stamp = false;      // pictures say who took them and when (stamp.hpp)
    std::uint64_t seed = 1;  // of lost packets
    Faults faults;           // of every camera of the rig
};

/// GigE Vision cameras, one per camera of the rig, each a thread of Aravis' own fake camera on an
/// address of its own. They run freely at the rig's rate, all triggered at the same instants, or by
/// software triggers; what they show is common to all of them. A client may change the frame rate
/// and the region, not the pixel format.
class CameraServer {
public:
    /// The addresses must be there (`app::bring_up_loopback`). Error kUnavailable names the camera
    /// that cannot listen.
    static Expected<std::unique_ptr<CameraServer>> start(ShownPictures shown,
                                                         const ServerOptions& options);
    ~CameraServer();

    /// Follows the outages of `ServerOptions::faults` until the stop.
    void follow_outages(std::stop_token stop);

    /// The room is empty from now on for `ServerOptions::empty_time`.
    void empty_room();

    /// Pictures that each camera has sent.
    std::vector<std::uint64_t> num_sent() const;

    const std::vector<CameraPlace>& places() const;

private:
    struct Impl;
    explicit CameraServer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::simulated_cameras
